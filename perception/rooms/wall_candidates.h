#pragma once

#include <vector>

#include "perception/rooms/cluster_border.h"
#include "perception/rooms/wall_map.h"

namespace sgraphs {

// A line that a room's outline may run along. The room is where normal.p + d > 0, as far as walls tell.
struct OutlineLine {
  Eigen::Vector2d normal = Eigen::Vector2d::UnitX();  // unit
  double d = 0;
  std::vector<Wall> walls;  // that stand on it, all of them facing its normal; none: a border without walls

  double distance(const Eigen::Vector2d& p) const { return normal.dot(p) + d; }
};

// What a cluster's border says of walls.
struct BorderEvidence {
  std::vector<OutlineLine> lines;  // the longest walls first, then border that no wall explains
  // Space between the border and the walls behind it, where furniture stands: convex.
  std::vector<Polygon2d> furniture;
};

// Walls of which at least a stretch stands behind the border, up to furniture_depth_m, and faces it; no wall
// that belongs to the next room. `walls`: all of the storey that may be near.
BorderEvidence evidenceOf(const ClusterBorder& border, const std::vector<Wall>& walls,
                          double furniture_depth_m);

}  // namespace sgraphs
