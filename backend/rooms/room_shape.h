#pragma once

#include <cstddef>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "backend/graph/situational_graph.h"

namespace sgraphs {

// What the observations say of the heading of walls: of their turn about the vertical.
class HeadingEvidence {
 public:
  // Takes in what the graph has more than at the last call.
  void update(const SituationalGraph& graph);
  // [rad^2], relative to the keyframes that saw it; infinite for a plane never seen.
  double variance(PlaneId plane) const;

 private:
  size_t num_taken_ = 0;                   // of the graph's observations
  std::map<PlaneId, double> information_;  // 1 / rad^2
};

// Two walls of a room that are meant to be parallel or at right angles.
struct WallRelation {
  PlaneId a, b;  // a < b
  bool square = false;
  double sigma_rad = 0;
};

// The relations of one room's walls: opposed walls are parallel, neighbours in the polygon square, unless
// they are seen to be otherwise: by more than twice shape_sigma_rad and four sigma of their headings (a
// quarter more for those in `before`, so that a wall on the border does not come and go). The walls of a ring
// determine one relation less than there are walls; where there are more, each weighs less.
std::vector<WallRelation> wallRelations(const RoomObservation& room, const SituationalGraph& graph,
                                        const HeadingEvidence& headings, double shape_sigma_rad,
                                        const std::set<std::pair<PlaneId, PlaneId>>& before);

}  // namespace sgraphs
