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

RelativePose alongVertical(RelativePose ride, const SE3& T_map_from, const Eigen::Vector3d& up_map) {
  // The covariance is that of a small motion at the far end.
  const Eigen::Matrix3d R = ride.T_from_to.matrix3();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(ride.covariance.topLeftCorner<3, 3>());
  const Eigen::Vector3d up_from = T_map_from.rotation.conjugate() * up_map.normalized();
  Eigen::Vector3d open_from = R * eigen.eigenvectors().col(2);
  if (open_from.dot(up_from) < 0) open_from = -open_from;
  const double rise_m = open_from.dot(ride.T_from_to.translation);
  ride.T_from_to.translation += rise_m * (up_from - open_from);
  const Eigen::Quaterniond turn = Eigen::Quaterniond::FromTwoVectors(open_from, up_from);
  Matrix6d J = Matrix6d::Identity();
  J.topLeftCorner<3, 3>() = R.transpose() * turn.toRotationMatrix() * R;
  ride.covariance = J * ride.covariance * J.transpose();
  return ride;
}

}  // namespace sgraphs
