#pragma once

#include "common/geometry/se3.h"

namespace sgraphs {

// R_map_body of a body that sees `up_body` (unit), with map's z up and the body's x axis heading along map's
// x: roll and pitch only. Regular unless body x points straight up or down.
Eigen::Quaterniond levelledRotation(const Eigen::Vector3d& up_body);

}  // namespace sgraphs
