#include "backend/factors/center_walls_cost.h"

#include <cmath>
#include <stdexcept>

#include "backend/factors/plane_manifold.h"

namespace sgraphs {

std::unique_ptr<CenterWallsCost> CenterWallsCost::Create(double height_m, double sigma_m) {
  if (!std::isfinite(height_m) || !(sigma_m > 0) || !std::isfinite(sigma_m))
    throw std::logic_error("CenterWallsCost: height must be finite, sigma_m positive and finite");
  return std::unique_ptr<CenterWallsCost>(new CenterWallsCost(height_m, sigma_m));
}

CenterWallsCost::CenterWallsCost(double height_m, double sigma_m)
    : height_m_(height_m), sqrt_information_(1.0 / sigma_m) {
  set_num_residuals(1);
  *mutable_parameter_block_sizes() = {2, PlaneManifold::kAmbientSize, PlaneManifold::kAmbientSize};
}

bool CenterWallsCost::Evaluate(double const* const* parameters, double* residuals, double** jacobians) const {
  const Eigen::Vector3d p(parameters[0][0], parameters[0][1], height_m_);
  const PlaneState a = PlaneManifold::load(parameters[1]), b = PlaneManifold::load(parameters[2]);
  residuals[0] = sqrt_information_ * (a.distance(p) - b.distance(p));
  if (jacobians == nullptr) return true;

  if (jacobians[0] != nullptr) {
    Eigen::Map<Eigen::Matrix<double, 1, 2>> J(jacobians[0]);
    J = sqrt_information_ * (a.normal - b.normal).head<2>().transpose();
  }
  const auto byPlane = [&](const PlaneState& plane, double weight, double* jacobian) {
    Eigen::Map<Eigen::Matrix<double, 1, 7>> J(jacobian);
    J << weight * (p - plane.anchor).transpose(), weight, 0.0, 0.0, 0.0;
  };
  if (jacobians[1] != nullptr) byPlane(a, sqrt_information_, jacobians[1]);
  if (jacobians[2] != nullptr) byPlane(b, -sqrt_information_, jacobians[2]);
  return true;
}

}  // namespace sgraphs
