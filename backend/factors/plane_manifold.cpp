#include "backend/factors/plane_manifold.h"

namespace sgraphs {

bool PlaneManifold::Plus(const double* x, const double* delta, double* x_plus_delta) const {
  x_plus_delta[3] = x[3] + delta[2];
  return UnitVectorManifold().Plus(x, delta, x_plus_delta);
}

bool PlaneManifold::PlusJacobian(const double* x, double* jacobian) const {
  Eigen::Map<Eigen::Matrix<double, 4, 3, Eigen::RowMajor>> J(jacobian);
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
  Eigen::Map<Eigen::Matrix<double, 3, 4, Eigen::RowMajor>> J(jacobian);
  J.setZero();
  J.topLeftCorner<2, 3>() = tangentBasis(Eigen::Map<const Eigen::Vector3d>(x)).transpose();
  J(2, 3) = 1.0;
  return true;
}

}  // namespace sgraphs
