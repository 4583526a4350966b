#pragma once

#include <ceres/cost_function.h>
#include <Eigen/Core>

#include <memory>

namespace sgraphs {

// Where a centre lies in a direction that no pair of walls determines: along a corridor. It is held to a
// keyframe, not to the map, so that it moves with what was seen from there.
//   r = w_xy.(c - q_xy) / sigma,  q = T z,  w = R u,  T = T_map_body, R its rotation
// z is the centre and u the direction as the keyframe has them, in body. With T exp(rho, omega):
//   dq = R (rho - [z] omega),  dw = -R [u] omega,
//   dr = (w_xy.dc - w_xy.dq_xy + (c - q)_xy.dw_xy) / sigma
class CenterAnchorCost final : public ceres::CostFunction {
 public:
  // Throws std::logic_error unless all is finite, along_body a unit vector and sigma_m positive.
  static std::unique_ptr<CenterAnchorCost> Create(const Eigen::Vector3d& center_body,
                                                  const Eigen::Vector3d& along_body, double sigma_m);

  // parameters: the centre in map (2); T_map_body as PoseManifold stores it.
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  CenterAnchorCost(const Eigen::Vector3d& center_body, const Eigen::Vector3d& along_body, double sigma_m);

  Eigen::Vector3d center_body_, along_body_;
  double sqrt_information_;
};

}  // namespace sgraphs
