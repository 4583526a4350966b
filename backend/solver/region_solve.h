#pragma once

#include <vector>

#include "backend/solver/state_graph.h"

namespace sgraphs {

struct RegionOutcome {
  bool usable = true;     // false: the states are as before
  bool converged = true;  // false: the iterations ran out
  int iterations = 0;
};

// Minimises all factors that touch the free states (ascending ids, none held) over those states.
// Done when the root mean square of the states' steps (metres and radians) is below settled_step.
RegionOutcome solveRegion(StateGraph& graph, const std::vector<int>& free, int max_iterations,
                          double settled_step);

}  // namespace sgraphs
