#pragma once

#include <optional>
#include <vector>

#include "perception/odometry/surfel.h"

namespace sgraphs {

struct UpDirection {
  Eigen::Vector3d up_body;  // unit
  double sigma_rad;         // about each horizontal axis
};

// Up from the floor that the robot stands on: a plane through the patches below the body that face upwards
// within 30 degrees of its z axis. Nothing if too few patches see a floor. The stated error has a floor of 5
// mrad: buildings' floors are level to about that.
std::optional<UpDirection> floorUnderStart(const std::vector<Surfel>& surfels);

}  // namespace sgraphs
