#include "backend/factors/plane_manifold.h"

#include <algorithm>

namespace sgraphs {

PlaneState PlaneManifold::load(const double* x) {
  return {Eigen::Vector3d(x), x[3], Eigen::Vector3d(x + 4)};
}

void PlaneManifold::store(const PlaneState& plane, double* x) {
  Eigen::Map<Eigen::Matrix<double, kAmbientSize, 1>> out(x);
  out << plane.normal, plane.offset_m, plane.anchor;
}

bool PlaneManifold::Plus(const double* x, const double* delta, double* x_plus_delta) const {
  x_plus_delta[3] = x[3] + delta[2];
  std::copy_n(x + 4, 3, x_plus_delta + 4);
  return UnitVectorManifold().Plus(x, delta, x_plus_delta);
}

bool PlaneManifold::PlusJacobian(const double* x, double* jacobian) const {
  Eigen::Map<Eigen::Matrix<double, kAmbientSize, kTangentSize, Eigen::RowMajor>> J(jacobian);
  J.setZero();
  J.topLeftCorner<3, 2>() = tangentBasis(Eigen::Map<const Eigen::Vector3d>(x));
  J(3, 2) = 1.0;
  return true;
}

bool PlaneManifold::Minus(const double* y, const double* x, double* y_minus_x) const {
  y_minus_x[2] = y[3] - x[3];
  return UnitVectorManifold().Minus(y, x, y_minus_x);
}

bool PlaneManifold::MinusJacobian(const double* x, double* jacobian) const {
  Eigen::Map<Eigen::Matrix<double, kTangentSize, kAmbientSize, Eigen::RowMajor>> J(jacobian);
  J.setZero();
  J.topLeftCorner<2, 3>() = tangentBasis(Eigen::Map<const Eigen::Vector3d>(x)).transpose();
  J(2, 3) = 1.0;
  return true;
}

}  // namespace sgraphs
