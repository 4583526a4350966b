#pragma once

#include <ceres/cost_function.h>
#include <Eigen/Core>

#include <memory>

namespace sgraphs {

// A room of a storey, at the measured offset from the storey's centre.
//   r = (c_room - c_floor - offset) / sigma
// sigma is the storey's size: the factor says which storey the room is of, and pulls at nothing. The offset
// is in the map's axes.
class FloorRoomCost final : public ceres::CostFunction {
 public:
  // Throws std::logic_error unless the offset is finite and sigma_m positive and finite.
  static std::unique_ptr<FloorRoomCost> Create(const Eigen::Vector2d& offset_map, double sigma_m);

  // parameters: the centres in map (2 each), floor and room.
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  FloorRoomCost(const Eigen::Vector2d& offset_map, double sigma_m);

  Eigen::Vector2d offset_map_;
  double sqrt_information_;
};

}  // namespace sgraphs
