#pragma once

#include <Eigen/Core>

#include "common/geometry/tangent_basis.h"

namespace sgraphs {

// A plane as a state: n.(p - anchor) + offset = 0. The anchor is a constant that travels with the state;
// any point will do, but tilt and offset are coupled as little as it lies close to what was seen.
struct PlaneState {
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  // unit
  double offset_m = 0;                                // signed distance of the anchor to the plane
  Eigen::Vector3d anchor = Eigen::Vector3d::Zero();

  double distance(const Eigen::Vector3d& p) const { return normal.dot(p - anchor) + offset_m; }
  // The same plane about another anchor.
  PlaneState anchoredAt(const Eigen::Vector3d& p) const { return {normal, distance(p), p}; }
};

// Covariance of a plane state's (tilt_u [rad], tilt_v [rad], offset [m]), carried from one anchor to another:
// the lever turns tilt into offset, offset' = offset + n.(to - from), and n moves along tangentBasis(n) tilt.
inline Eigen::Matrix3d movedCovariance(const Eigen::Matrix3d& covariance, const Eigen::Vector3d& normal,
                                       const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  Eigen::Matrix3d J = Eigen::Matrix3d::Identity();
  J.block<1, 2>(2, 0) = (to - from).transpose() * tangentBasis(normal);
  return J * covariance * J.transpose();
}

}  // namespace sgraphs
