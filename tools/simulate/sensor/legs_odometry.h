#pragma once

#include <cstdint>
#include <vector>

#include "common/types/session.h"
#include "tools/simulate/sensor/legs_model.h"
#include "tools/simulate/walk/trajectory.h"

namespace sgraphs::simulate {

// Body in the robot's own odometry frame: z up, the identity at the trajectory's start (for a body that
// stands level there), one sample per period up to the trajectory's end. A sample of instant t carries the
// stamp t + clock_offset_s of the robot's own clock.
std::vector<BodyOdometry> simulateLegsOdometry(const Trajectory& trajectory, const LegsOdometryModel& model,
                                               uint64_t seed);

}  // namespace sgraphs::simulate
