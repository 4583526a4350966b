#pragma once

#include <span>
#include <vector>

#include "common/types/keyframe.h"
#include "common/types/lidar_scan.h"
#include "common/types/session.h"
#include "perception/odometry/odometry.h"
#include "perception/odometry/surfel_map.h"
#include "tools/simulate/scene/test_worlds.h"
#include "tools/simulate/sensor/legs_odometry.h"

namespace sgraphs::testing_support {

// T_dst_src from a place and roll, pitch, yaw in degrees (turned about z, then y, then x).
SE3 poseOf(const Eigen::Vector3d& xyz, double roll_deg, double pitch_deg, double yaw_deg);
// T_body_lidar of a sensor that looks to the left.
inline const SE3 kMount = poseOf({0.12, 0, 0.31}, 0, 0, 90);

// Length of the translation [m] and angle [rad] of a^-1 b.
double distance(const SE3& a, const SE3& b);
double angle(const SE3& a, const SE3& b);

// Every return of the scan passes.
std::vector<int32_t> allOf(const LidarScan& scan);

// Patches of a scan whose body frame is the lidar frame, without the box of the robot's body.
std::vector<Surfel> surfelsOf(const LidarScan& scan);
SurfelMap mapOf(const std::vector<Surfel>& surfels, const SE3& T_map_body);

// What a robot measured on its walk, and the truth.
struct SimulatedWalk {
  simulate::Trajectory truth;  // T_building_body
  SE3 T_body_lidar;
  std::vector<LidarScan> scans;
  std::vector<BodyOdometry> legs;

  // Samples from the last one at or before the scan's begin to the first one at or after its end.
  std::span<const BodyOdometry> legsOf(const LidarScan& scan) const;
};

SimulatedWalk walkThrough(const simulate::Scene& scene, uint64_t seed,
                          const simulate::LegsOdometryModel& legs = {});
simulate::LegsOdometryModel exactLegs();

// A furnished room of 7 x 5 m, and a walk of 6 m through it with turns and gait. About 10 s.
simulate::Scene furnishedRoom();

struct OdometryRun {
  std::vector<OdometryEstimate> estimates;
  std::vector<Keyframe> keyframes;
};

OdometryRun runOdometry(const SimulatedWalk& walk, OdometryMode mode, const OdometryConfig& config = {});

// Root mean square of the translation errors after alignment by rotation and translation [m].
double trajectoryError(const OdometryRun& run, const simulate::Trajectory& truth);

}  // namespace sgraphs::testing_support
