#pragma once

#include <vector>

#include "perception/rooms/cluster_border.h"
#include "perception/rooms/wall_map.h"

namespace sgraphs {

// A line that a room's outline may run along.
struct OutlineLine {
  Eigen::Vector2d normal = Eigen::Vector2d::UnitX();  // unit
  double d = 0;
  std::vector<Wall> walls;  // that stand on it and face either way; none: a border without walls

  double distance(const Eigen::Vector2d& p) const { return normal.dot(p) + d; }
};

// What a cluster's border says of walls.
struct BorderEvidence {
  std::vector<OutlineLine> lines;  // the longest walls first, then border that no wall explains
  size_t num_seen = 0;             // lines before those along border that nobody has looked behind
  // Space between the border and the walls behind it, where furniture stands: convex.
  std::vector<Polygon2d> furniture;
};

// Heights between which a storey's walls stand [m, in map].
struct StoreyBand {
  double bottom_z_m = 0, top_z_m = 0;
  double low_z_m = 0;  // what ends below is furniture, or a parapet

  bool holds(const Wall& wall) const;
  bool isLow(const Wall& wall) const { return wall.top_z_m < low_z_m; }
};
StoreyBand bandAbove(double surface_z_m);

// How far behind what is known to be low a wall may stand: beds and tables hide no more.
constexpr double kLowFurniture_m = 2.5;

// Walls of which at least a stretch stands behind the border, up to furniture_depth_m (behind low things,
// kLowFurniture_m), and faces it; no wall that belongs to the next room. `walls`: all of the storey that may
// be near.
BorderEvidence evidenceOf(const ClusterBorder& border, const std::vector<Wall>& walls,
                          double furniture_depth_m);

}  // namespace sgraphs
