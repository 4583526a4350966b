#pragma once

#include <ceres/manifold.h>

#include "common/geometry/tangent_basis.h"

namespace sgraphs {

// Directions: the unit sphere in three doubles, tangent in radians along tangentBasis(n).
// Plus(n, delta) turns n by |delta| along the great circle. Ceres 2.1's SphereManifold turns by half of that
// scale, so that a standard deviation given in radians would be off by two.
class UnitVectorManifold final : public ceres::Manifold {
 public:
  static constexpr int kAmbientSize = 3;
  static constexpr int kTangentSize = 2;

  int AmbientSize() const override { return kAmbientSize; }
  int TangentSize() const override { return kTangentSize; }
  bool Plus(const double* x, const double* delta, double* x_plus_delta) const override;
  bool PlusJacobian(const double* x, double* jacobian) const override;
  bool Minus(const double* y, const double* x, double* y_minus_x) const override;
  bool MinusJacobian(const double* x, double* jacobian) const override;

  static Eigen::Vector3d plus(const Eigen::Vector3d& n, const Eigen::Vector2d& delta_rad);
  // The shortest turn from `from` to `to`; for opposite directions half a turn about the first axis.
  static Eigen::Vector2d minus(const Eigen::Vector3d& to, const Eigen::Vector3d& from);
};

}  // namespace sgraphs
