#include "backend/factors/unit_vector_manifold.h"

#include <cmath>

namespace sgraphs {

Eigen::Vector3d UnitVectorManifold::plus(const Eigen::Vector3d& n, const Eigen::Vector2d& delta_rad) {
  const double angle = delta_rad.norm();
  const double sinc = angle < 1e-8 ? 1.0 : std::sin(angle) / angle;
  return (std::cos(angle) * n + sinc * (tangentBasis(n) * delta_rad)).normalized();
}

Eigen::Vector2d UnitVectorManifold::minus(const Eigen::Vector3d& to, const Eigen::Vector3d& from) {
  const Eigen::Vector2d lateral = tangentBasis(from).transpose() * to;
  const double sine = lateral.norm(), cosine = from.dot(to);
  if (sine < 1e-12) return cosine > 0 ? lateral : Eigen::Vector2d(M_PI, 0);
  return std::atan2(sine, cosine) / sine * lateral;
}

bool UnitVectorManifold::Plus(const double* x, const double* delta, double* x_plus_delta) const {
  Eigen::Map<Eigen::Vector3d> out(x_plus_delta);
  out = plus(Eigen::Map<const Eigen::Vector3d>(x), Eigen::Map<const Eigen::Vector2d>(delta));
  return true;
}

bool UnitVectorManifold::PlusJacobian(const double* x, double* jacobian) const {
  Eigen::Map<Eigen::Matrix<double, 3, 2, Eigen::RowMajor>> J(jacobian);
  J = tangentBasis(Eigen::Map<const Eigen::Vector3d>(x));
  return true;
}

bool UnitVectorManifold::Minus(const double* y, const double* x, double* y_minus_x) const {
  Eigen::Map<Eigen::Vector2d> out(y_minus_x);
  out = minus(Eigen::Map<const Eigen::Vector3d>(y), Eigen::Map<const Eigen::Vector3d>(x));
  return true;
}

bool UnitVectorManifold::MinusJacobian(const double* x, double* jacobian) const {
  Eigen::Map<Eigen::Matrix<double, 2, 3, Eigen::RowMajor>> J(jacobian);
  J = tangentBasis(Eigen::Map<const Eigen::Vector3d>(x)).transpose();
  return true;
}

}  // namespace sgraphs
