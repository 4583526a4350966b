#pragma once

#include <Eigen/Core>
#include <utility>
#include <vector>

#include "backend/graph_builder.h"

namespace sgraphs {

// What is said to lie further off is refused: no map reaches there.
inline constexpr double kNoMapReaches_m = 1e5;

// What determines the centre of a room or a storey.
struct CenterEvidence {
  CenterOf of;
  std::vector<std::pair<PlaneId, PlaneId>> pairs;        // opposed walls, nodes of the graph
  bool finite = false;                                   // a finite room
  Eigen::Vector2d center_map = Eigen::Vector2d::Zero();  // as seen, for directions that no pair determines
  KeyframeId anchor;                                     // that directions without a pair are held to
  double height_m = 0;                                   // in map, where the walls were seen
  double wall_sigma_m = 0;
  double along_sigma_m = 0;
};

// Makes the centre's factors what the evidence asks for, no more and no fewer than determine it: one for a
// pair of walls, at most two, and one to the anchor for each direction left open. What is there already and
// says the same stays as it is.
void bindCenter(const CenterEvidence& evidence, GraphBuilder& builder);

}  // namespace sgraphs
