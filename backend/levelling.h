#pragma once

#include "common/types/keyframe.h"

namespace sgraphs {

// R_map_body of a body that sees `up_body` (unit), with map's z up and the body's x axis heading along map's
// x: roll and pitch only. Regular unless body x points straight up or down.
Eigen::Quaterniond levelledRotation(const Eigen::Vector3d& up_body);

// A ride in a lift goes straight up or down, whose direction the map knows better than the odometry, and the
// way is long: the measurement with its open direction turned to the map's vertical.
RelativePose alongVertical(RelativePose ride, const SE3& T_map_from, const Eigen::Vector3d& up_map);

}  // namespace sgraphs
