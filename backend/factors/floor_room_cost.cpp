#include "backend/factors/floor_room_cost.h"

#include <cmath>
#include <stdexcept>

namespace sgraphs {

std::unique_ptr<FloorRoomCost> FloorRoomCost::Create(const Eigen::Vector2d& offset_map, double sigma_m) {
  if (!offset_map.allFinite() || !(sigma_m > 0) || !std::isfinite(sigma_m))
    throw std::logic_error("FloorRoomCost: offset must be finite, sigma_m positive and finite");
  return std::unique_ptr<FloorRoomCost>(new FloorRoomCost(offset_map, sigma_m));
}

FloorRoomCost::FloorRoomCost(const Eigen::Vector2d& offset_map, double sigma_m)
    : offset_map_(offset_map), sqrt_information_(1.0 / sigma_m) {
  set_num_residuals(2);
  *mutable_parameter_block_sizes() = {2, 2};
}

bool FloorRoomCost::Evaluate(double const* const* parameters, double* residuals, double** jacobians) const {
  const Eigen::Map<const Eigen::Vector2d> floor(parameters[0]), room(parameters[1]);
  Eigen::Map<Eigen::Vector2d> r(residuals);
  r = sqrt_information_ * (room - floor - offset_map_);
  if (jacobians == nullptr) return true;

  for (int i = 0; i < 2; ++i) {
    if (jacobians[i] == nullptr) continue;
    Eigen::Map<Eigen::Matrix<double, 2, 2, Eigen::RowMajor>> J(jacobians[i]);
    J = (i == 0 ? -sqrt_information_ : sqrt_information_) * Eigen::Matrix2d::Identity();
  }
  return true;
}

}  // namespace sgraphs
