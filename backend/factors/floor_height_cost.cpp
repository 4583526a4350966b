#include "backend/factors/floor_height_cost.h"

#include <cmath>
#include <stdexcept>

#include "backend/factors/plane_manifold.h"

namespace sgraphs {

std::unique_ptr<FloorHeightCost> FloorHeightCost::Create(double sigma_m) {
  if (!(sigma_m > 0) || !std::isfinite(sigma_m))
    throw std::logic_error("FloorHeightCost: sigma_m must be positive and finite");
  return std::unique_ptr<FloorHeightCost>(new FloorHeightCost(sigma_m));
}

FloorHeightCost::FloorHeightCost(double sigma_m) : sqrt_information_(1.0 / sigma_m) {
  set_num_residuals(1);
  *mutable_parameter_block_sizes() = {1, PlaneManifold::kAmbientSize};
}

bool FloorHeightCost::Evaluate(double const* const* parameters, double* residuals, double** jacobians) const {
  const PlaneState plane = PlaneManifold::load(parameters[1]);
  residuals[0] = sqrt_information_ * (parameters[0][0] - (plane.anchor - plane.offset_m * plane.normal).z());
  if (jacobians == nullptr) return true;

  if (jacobians[0] != nullptr) jacobians[0][0] = sqrt_information_;
  if (jacobians[1] != nullptr) {
    Eigen::Map<Eigen::Matrix<double, 1, 7>> J(jacobians[1]);
    J << 0.0, 0.0, sqrt_information_ * plane.offset_m, sqrt_information_ * plane.normal.z(), 0.0, 0.0, 0.0;
  }
  return true;
}

}  // namespace sgraphs
