#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/types/free_space.h"
#include "perception/rooms/simple_polygon.h"

namespace sgraphs {

// A straight edge of a cluster's border.
struct BorderEdge {
  Eigen::Vector2d a, b;  // the free space is on the left
  BorderKind kind = BorderKind::kObstacle;

  double length() const { return (b - a).norm(); }
  Eigen::Vector2d middle() const { return 0.5 * (a + b); }
  // Unit, away from the free space.
  Eigen::Vector2d outward() const { return Eigen::Vector2d(b.y() - a.y(), a.x() - b.x()).normalized(); }
};

// The border of a cluster, ready to be explained by walls.
struct ClusterBorder {
  Polygon2d polygon;              // as it came
  std::vector<BorderEdge> edges;  // without the steps of the grid, each of one kind, in order
  double length_m = 0;
  double frontier_m = 0;  // length that nobody has looked behind

  double frontierShare() const { return length_m > 0 ? frontier_m / length_m : 1.0; }
};

ClusterBorder borderOf(const FreeSpaceCluster& cluster);

}  // namespace sgraphs
