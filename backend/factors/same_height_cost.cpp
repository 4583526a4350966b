#include "backend/factors/same_height_cost.h"

#include <cmath>
#include <stdexcept>

#include "backend/factors/plane_manifold.h"

namespace sgraphs {

std::unique_ptr<SameHeightCost> SameHeightCost::Create(double sigma_m) {
  if (!(sigma_m > 0) || !std::isfinite(sigma_m))
    throw std::logic_error("SameHeightCost: sigma_m must be positive and finite");
  return std::unique_ptr<SameHeightCost>(new SameHeightCost(sigma_m));
}

SameHeightCost::SameHeightCost(double sigma_m) : sqrt_information_(1.0 / sigma_m) {
  set_num_residuals(1);
  *mutable_parameter_block_sizes() = {PlaneManifold::kAmbientSize, PlaneManifold::kAmbientSize,
                                      UnitVectorManifold::kAmbientSize};
}

bool SameHeightCost::Evaluate(double const* const* parameters, double* residuals, double** jacobians) const {
  const PlaneState a = PlaneManifold::load(parameters[0]), b = PlaneManifold::load(parameters[1]);
  const Eigen::Vector3d up(parameters[2]);
  const Eigen::Vector3d apart = (a.anchor - a.offset_m * a.normal) - (b.anchor - b.offset_m * b.normal);
  residuals[0] = sqrt_information_ * up.dot(apart);
  if (jacobians == nullptr) return true;

  const auto byPlane = [&](const PlaneState& plane, double weight, double* jacobian) {
    Eigen::Map<Eigen::Matrix<double, 1, 7>> J(jacobian);
    J << weight * plane.offset_m * up.transpose(), weight * plane.normal.dot(up), 0.0, 0.0, 0.0;
  };
  if (jacobians[0] != nullptr) byPlane(a, -sqrt_information_, jacobians[0]);
  if (jacobians[1] != nullptr) byPlane(b, sqrt_information_, jacobians[1]);
  if (jacobians[2] != nullptr) {
    Eigen::Map<Eigen::Matrix<double, 1, 3>> J(jacobians[2]);
    J = sqrt_information_ * apart.transpose();
  }
  return true;
}

}  // namespace sgraphs
