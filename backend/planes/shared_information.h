#pragma once

#include "common/geometry/se3.h"

namespace sgraphs {

// Odometry and plane observations of a keyframe come from the same points, so the two must not count as
// independent. A relative pose that was measured by scan registration keeps its information only where the
// planes of the keyframe say nothing: with I_z = V^-T V^-1 and I_planes = V^-T diag(m) V^-1, each direction
// of V keeps 1 / (1 + strength m / (1 + m)) of its own. Of coordinates it does not depend.
//   covariance: of T_from_to, tangent of `to` (positive definite)
//   planes: information about the pose of `to` (same tangent) from planes that were mapped before
// strength 0 changes nothing.
Matrix6d withoutSharedInformation(const Matrix6d& covariance, const Matrix6d& planes, double strength);

}  // namespace sgraphs
