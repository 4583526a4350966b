#include "backend/factors/relative_pose_cost.h"

#include <Eigen/Cholesky>
#include <stdexcept>

#include "backend/factors/pose_manifold.h"

namespace sgraphs {

std::unique_ptr<RelativePoseCost> RelativePoseCost::Create(const SE3& T_i_j, const Matrix6d& covariance) {
  const Eigen::LLT<Matrix6d> llt(covariance);
  if (!T_i_j.isFinite() || !covariance.allFinite() || llt.info() != Eigen::Success)
    throw std::logic_error("RelativePoseCost: measurement not finite or covariance not positive definite");
  // S = C C^T, hence L = C^-1.
  const Matrix6d sqrt_information = llt.matrixL().solve(Matrix6d::Identity());
  return std::unique_ptr<RelativePoseCost>(new RelativePoseCost(T_i_j.inverse(), sqrt_information));
}

RelativePoseCost::RelativePoseCost(const SE3& T_j_i, const Matrix6d& sqrt_information)
    : T_j_i_(T_j_i), sqrt_information_(sqrt_information) {
  set_num_residuals(6);
  *mutable_parameter_block_sizes() = {PoseManifold::kAmbientSize, PoseManifold::kAmbientSize};
}

bool RelativePoseCost::Evaluate(double const* const* parameters, double* residuals,
                                double** jacobians) const {
  const SE3 X_i_j = PoseManifold::load(parameters[0]).inverse() * PoseManifold::load(parameters[1]);
  const Vector6d error = se3Log(T_j_i_ * X_i_j);
  Eigen::Map<Vector6d> r(residuals);
  r.noalias() = sqrt_information_ * error;
  if (jacobians == nullptr) return true;

  const Matrix6d J_j = sqrt_information_ * se3RightJacobianInverse(error);
  using AmbientJacobian = Eigen::Matrix<double, 6, 7, Eigen::RowMajor>;
  if (jacobians[0] != nullptr) {
    Eigen::Map<AmbientJacobian> J(jacobians[0]);
    J = -(J_j * se3Adjoint(X_i_j.inverse())) * PoseManifold::minusJacobian(parameters[0]);
  }
  if (jacobians[1] != nullptr) {
    Eigen::Map<AmbientJacobian> J(jacobians[1]);
    J = J_j * PoseManifold::minusJacobian(parameters[1]);
  }
  return true;
}

}  // namespace sgraphs
