#pragma once

#include <optional>
#include <span>

#include "common/types/session.h"
#include "perception/odometry/odometry_config.h"
#include "perception/odometry/registration.h"

namespace sgraphs {

// Pose of the legs' odometry at an instant: between samples at constant twist; after the last sample at the
// twist of the last two, at most 0.2 s; nothing farther outside.
std::optional<SE3> legsPoseAt(std::span<const BodyOdometry> samples, Time time);

// Covariance of a motion measured by the legs: a share of the distance and of the rotation, plus a noise.
Matrix6d legsCovariance(const SE3& motion, const LegsConfig& config);

// The legs' motion between the knots of a scan; nothing if the samples do not reach over the scan.
std::optional<std::vector<SE3>> legsMotion(std::span<const BodyOdometry> samples, Time begin, Time end,
                                           int segments);

}  // namespace sgraphs
