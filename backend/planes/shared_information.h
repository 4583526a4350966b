#pragma once

#include <vector>

#include "common/geometry/se3.h"
#include "common/types/plane.h"

namespace sgraphs {

// Odometry and plane observations of a keyframe come from the same points, so the two must not count as
// independent. A relative pose that was measured by scan registration keeps its information only where the
// planes of the keyframe say nothing: with I_z = V^-T V^-1 and I_planes = V^-T diag(m) V^-1, each direction
// of V keeps 1 / (1 + strength m / (1 + m)) of its own. Of coordinates it does not depend.
//   covariance: of T_from_to, tangent of `to` (positive definite)
//   planes: information about the pose of `to` (same tangent) from planes that were mapped before
// strength 0 changes nothing.
Matrix6d withoutSharedInformation(const Matrix6d& covariance, const Matrix6d& planes, double strength);

// The planes of one keyframe share the error of the keyframe's pose in its cloud (pose_sigma, contained in
// each covariance). As independent observations, n planes would average it down to 1/n, which more planes
// cannot do. So each covariance gets the shared part n - 1 times more, with n, by direction, the number of
// planes' worth of information about it: together they then say as much of the pose as the shared error
// allows.
void keepSharedError(const Vector6d& pose_sigma, std::vector<PlaneObservation>& planes);

}  // namespace sgraphs
