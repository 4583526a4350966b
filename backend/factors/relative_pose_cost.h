#pragma once

#include <ceres/cost_function.h>

#include <memory>

#include "common/geometry/se3.h"

namespace sgraphs {

// Two poses against their measured relative pose Z = T_i_j with covariance S (of Z's right perturbation).
// Odometry, neighbours and loops are all this factor.
//   r = L Log(E),  E = Z^-1 X_i^-1 X_j,  L^T L = S^-1
// With X exp(d) on the right of either pose and J = J_r^-1(Log E):
//   X_j: E exp(d_j)                                         => dr = L J d_j
//   X_i: Z^-1 exp(-d_i) X_i^-1 X_j = E exp(-Ad(X_j^-1 X_i) d_i)  => dr = -L J Ad(X_j^-1 X_i) d_i
class RelativePoseCost final : public ceres::CostFunction {
 public:
  // Throws std::logic_error unless the measurement is finite and the covariance positive definite.
  static std::unique_ptr<RelativePoseCost> Create(const SE3& T_i_j, const Matrix6d& covariance);

  // parameters: X_i, X_j as PoseManifold stores them.
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  RelativePoseCost(const SE3& T_j_i, const Matrix6d& sqrt_information);

  SE3 T_j_i_;  // measured
  Matrix6d sqrt_information_;
};

}  // namespace sgraphs
