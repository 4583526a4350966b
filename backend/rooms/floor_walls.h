#pragma once

#include <set>
#include <utility>
#include <vector>

#include "backend/graph/situational_graph.h"

namespace sgraphs {

// The opposed walls of a storey that are farthest apart, and those across them: the paper's, for a building
// in any heading.
struct FloorWalls {
  std::vector<std::pair<PlaneId, PlaneId>> pairs;  // none, one or two; a < b
  double size_m = 0;                               // of the widest
};

// A pair in `before` stays while no other is wider by 0.25 m.
FloorWalls wallsOfFloor(const SituationalGraph& graph, FloorId floor,
                        const std::set<std::pair<PlaneId, PlaneId>>& before);

// The largest level plane seen from above within 0.3 m of the height, or `before` while it is one of these.
PlaneId walkingSurface(const SituationalGraph& graph, FloorId floor, double z_m, PlaneId before);

}  // namespace sgraphs
