#pragma once

#include <Eigen/Geometry>

#include "common/types/free_space.h"
#include "tools/simulate/scene/scene.h"

namespace sgraphs::test {

// The wall that a doorway is in.
struct Doorframe {
  Eigen::Vector2d along = Eigen::Vector2d::UnitX(), normal = Eigen::Vector2d::UnitY();  // unit
  double thickness_m = 0.1;
};
Doorframe doorframeOf(const simulate::Scene& scene, const simulate::Doorway& door);

// The cells of the map's grid that are free in a room, up to the middle of its doors, as a cluster: its
// largest connected part, whose border has a corner at every step of the grid.
FreeSpaceCluster freeCellsOf(const simulate::Scene& scene, const simulate::Room& room, double cell_m,
                             const Eigen::Rotation2Dd& rotation, const Eigen::Vector2d& offset_m);

}  // namespace sgraphs::test
