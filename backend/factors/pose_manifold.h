#pragma once

#include <ceres/manifold.h>

#include "common/geometry/se3.h"

namespace sgraphs {

// SE(3) as seven doubles, [tx ty tz qx qy qz qw] (Eigen's order of coefficients), with the tangent of se3.h:
// translation [m], then rotation [rad], perturbed on the right: Plus(T, delta) = T * se3Exp(delta).
// Ceres' own quaternion manifolds take half angles; ours takes radians, so that covariances keep their units.
class PoseManifold final : public ceres::Manifold {
 public:
  static constexpr int kAmbientSize = 7;
  static constexpr int kTangentSize = 6;
  // Row-major as Ceres stores Jacobians.
  using TangentFromAmbient = Eigen::Matrix<double, 6, 7, Eigen::RowMajor>;

  int AmbientSize() const override { return kAmbientSize; }
  int TangentSize() const override { return kTangentSize; }
  bool Plus(const double* x, const double* delta, double* x_plus_delta) const override;
  bool PlusJacobian(const double* x, double* jacobian) const override;
  bool Minus(const double* y, const double* x, double* y_minus_x) const override;
  bool MinusJacobian(const double* x, double* jacobian) const override;

  static SE3 load(const double* x);
  static void store(const SE3& T, double* x);

  // Jacobian of Minus(., x) at x. A cost that knows its derivative J by the tangent hands Ceres J times this
  // matrix: Ceres multiplies by PlusJacobian, and the product of the two Jacobians is the identity.
  static TangentFromAmbient minusJacobian(const double* x);
};

}  // namespace sgraphs
