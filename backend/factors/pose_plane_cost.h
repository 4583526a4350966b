#pragma once

#include <ceres/cost_function.h>

#include <memory>

#include "common/geometry/tangent_basis.h"
#include "common/types/plane.h"

namespace sgraphs {

// A plane seen from a keyframe, z and c its normal and centroid in body, S the covariance of what the
// observation is off by: true normal = z + B(z) tilt, and the true plane passes at c + offset z (plane.h).
//   r = L [ B(z)^T v ; -(n.(T c - a) + o) ],  v = R^T n,  L^T L = S^-1,  T = T_map_body, R its rotation
// With the true states, v = z + B tilt gives B^T v = tilt, and the distance of c to a plane through
// c + offset z is -offset: the bracket is the error itself, so its covariance is S, cross terms included.
// B is fixed by the measurement: regular up to 90 degrees, the association sees to the hemisphere.
// With T exp(rho, w): dv = [v] w and d(T c) = R (rho - [c] w), hence
//   d(B^T v) = B^T [v] w,  d(dist) = v.rho + (c x v).w
// and by the plane: d(B^T v) = B^T R^T dn,  d(dist) = (T c - a).dn + do.
class PosePlaneCost final : public ceres::CostFunction {
 public:
  // Throws std::logic_error unless the normal is a unit vector, all is finite and the covariance positive
  // definite.
  static std::unique_ptr<PosePlaneCost> Create(const PlaneObservation& observation);

  // parameters: T_map_body as PoseManifold stores it; the plane in map (PlaneManifold).
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  PosePlaneCost(const PlaneObservation& observation, const Eigen::Matrix3d& sqrt_information);

  Eigen::Matrix<double, 2, 3> basis_;  // B(z)^T
  Eigen::Vector3d centroid_body_;
  Eigen::Matrix3d sqrt_information_;
};

}  // namespace sgraphs
