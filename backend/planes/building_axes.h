#pragma once

#include <map>

#include "backend/graph/situational_graph.h"

namespace sgraphs {

// The building's own horizontal axes, and labels relative to them. The direction is kept between calls: it
// follows the walls, and of its four quarter turns it takes the one nearest to the last, so that labels do
// not flip with the start heading.
class BuildingAxes {
 public:
  // Looks at all upright planes, weighted by the area of their extent.
  void update(const std::map<PlaneId, PlaneNode>& planes, const Eigen::Vector3d& up_map);

  // Heading of the x axis about up [rad]; 0 until there are walls.
  double heading_rad() const { return heading_rad_; }
  // Horizontal if the normal is nearer to up than to the horizontal plane's axes; else the nearer axis.
  PlaneLabel label(const Eigen::Vector3d& normal_map, const Eigen::Vector3d& up_map) const;

 private:
  double heading_rad_ = 0;
};

}  // namespace sgraphs
