#include "backend/factors/up_cost.h"

#include <cmath>
#include <stdexcept>

#include "backend/factors/pose_manifold.h"

namespace sgraphs {

std::unique_ptr<UpCost> UpCost::Create(const Eigen::Vector3d& up_body, double sigma_rad) {
  if (!(std::abs(up_body.norm() - 1.0) < 1e-6) || !(sigma_rad > 0) || !std::isfinite(sigma_rad))
    throw std::logic_error("UpCost: up_body must be a unit vector and sigma_rad positive");
  return std::unique_ptr<UpCost>(new UpCost(up_body, sigma_rad));
}

UpCost::UpCost(const Eigen::Vector3d& up_body, double sigma_rad)
    : weighted_basis_(tangentBasis(up_body).transpose() / sigma_rad) {
  set_num_residuals(2);
  *mutable_parameter_block_sizes() = {PoseManifold::kAmbientSize, 3};
}

bool UpCost::Evaluate(double const* const* parameters, double* residuals, double** jacobians) const {
  const Eigen::Matrix3d R_body_map = PoseManifold::load(parameters[0]).matrix3().transpose();
  const Eigen::Vector3d up_body = R_body_map * Eigen::Map<const Eigen::Vector3d>(parameters[1]);
  Eigen::Map<Eigen::Vector2d> r(residuals);
  r.noalias() = weighted_basis_ * up_body;
  if (jacobians == nullptr) return true;

  if (jacobians[0] != nullptr) {
    Eigen::Matrix<double, 2, 6> J = Eigen::Matrix<double, 2, 6>::Zero();
    J.rightCols<3>() = weighted_basis_ * skew(up_body);
    Eigen::Map<Eigen::Matrix<double, 2, 7, Eigen::RowMajor>> ambient(jacobians[0]);
    ambient = J * PoseManifold::minusJacobian(parameters[0]);
  }
  if (jacobians[1] != nullptr) {
    Eigen::Map<Eigen::Matrix<double, 2, 3, Eigen::RowMajor>> ambient(jacobians[1]);
    ambient = weighted_basis_ * R_body_map;
  }
  return true;
}

}  // namespace sgraphs
