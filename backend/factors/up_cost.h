#pragma once

#include <ceres/cost_function.h>

#include <memory>

#include "common/geometry/tangent_basis.h"

namespace sgraphs {

// The direction `up` of the map, seen from a keyframe as the unit vector z in body.
//   r = B(z)^T R^T u / sigma,  R = rotation of T_map_body, u in map
// B is fixed by the measurement, so the residual is smooth everywhere; it grows with the sine of the tilt:
// monotonic up to 90 degrees, zero again upside down (which no association of a walking robot comes near).
// With R exp(w): R^T u -> (I - [w]) v = v + [v] w, v = R^T u, hence dr = B^T [v] w / sigma; and with u + du:
// dr = B^T R^T du / sigma. Heading and position are free.
class UpCost final : public ceres::CostFunction {
 public:
  // Throws std::logic_error unless up_body is a unit vector and sigma_rad positive.
  static std::unique_ptr<UpCost> Create(const Eigen::Vector3d& up_body, double sigma_rad);

  // parameters: T_map_body as PoseManifold stores it; up in map (UnitVectorManifold).
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  UpCost(const Eigen::Vector3d& up_body, double sigma_rad);

  Eigen::Matrix<double, 2, 3> weighted_basis_;  // B(z)^T / sigma
};

}  // namespace sgraphs
