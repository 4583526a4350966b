#include "backend/factors/center_anchor_cost.h"

#include <cmath>
#include <stdexcept>

#include "backend/factors/pose_manifold.h"

namespace sgraphs {

std::unique_ptr<CenterAnchorCost> CenterAnchorCost::Create(const Eigen::Vector3d& center_body,
                                                           const Eigen::Vector3d& along_body,
                                                           double sigma_m) {
  if (!center_body.allFinite() || !(std::abs(along_body.norm() - 1.0) < 1e-6) || !(sigma_m > 0) ||
      !std::isfinite(sigma_m))
    throw std::logic_error("CenterAnchorCost: centre not finite, direction no unit vector, or no sigma");
  return std::unique_ptr<CenterAnchorCost>(new CenterAnchorCost(center_body, along_body, sigma_m));
}

CenterAnchorCost::CenterAnchorCost(const Eigen::Vector3d& center_body, const Eigen::Vector3d& along_body,
                                   double sigma_m)
    : center_body_(center_body), along_body_(along_body), sqrt_information_(1.0 / sigma_m) {
  set_num_residuals(1);
  *mutable_parameter_block_sizes() = {2, PoseManifold::kAmbientSize};
}

bool CenterAnchorCost::Evaluate(double const* const* parameters, double* residuals,
                                double** jacobians) const {
  const Eigen::Map<const Eigen::Vector2d> center(parameters[0]);
  const SE3 T_map_body = PoseManifold::load(parameters[1]);
  const Eigen::Matrix3d R = T_map_body.matrix3();
  const Eigen::Vector2d along = (R * along_body_).head<2>();
  const Eigen::Vector2d apart = center - (T_map_body * center_body_).head<2>();
  residuals[0] = sqrt_information_ * along.dot(apart);
  if (jacobians == nullptr) return true;

  if (jacobians[0] != nullptr) {
    Eigen::Map<Eigen::Matrix<double, 1, 2>> J(jacobians[0]);
    J = sqrt_information_ * along.transpose();
  }
  if (jacobians[1] != nullptr) {
    Eigen::Matrix<double, 1, 6> J;
    J.head<3>() = -along.transpose() * R.topRows<2>();
    J.tail<3>() = (along.transpose() * R.topRows<2>()) * skew(center_body_) -
                  (apart.transpose() * R.topRows<2>()) * skew(along_body_);
    Eigen::Map<Eigen::Matrix<double, 1, 7>> ambient(jacobians[1]);
    ambient = sqrt_information_ * J * PoseManifold::minusJacobian(parameters[1]);
  }
  return true;
}

}  // namespace sgraphs
