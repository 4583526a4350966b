#include "backend/levelling.h"

#include <algorithm>
#include <cmath>

namespace sgraphs {

// R = Ry(pitch) Rx(roll), so R^T z = (-sin pitch, sin roll cos pitch, cos roll cos pitch).
Eigen::Quaterniond levelledRotation(const Eigen::Vector3d& up_body) {
  const double pitch = -std::asin(std::clamp(up_body.x(), -1.0, 1.0));
  const double roll = std::atan2(up_body.y(), up_body.z());
  return Eigen::AngleAxisd(pitch, Eigen::Vector3d::UnitY()) *
         Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitX());
}

}  // namespace sgraphs
