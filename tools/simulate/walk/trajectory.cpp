#include "tools/simulate/walk/trajectory.h"

#include <algorithm>
#include <utility>

namespace sgraphs::simulate {

Trajectory::Trajectory(Time start, Duration duration, Function T_building_body)
    : start_(start), duration_(duration), T_building_body_(std::move(T_building_body)) {}

SE3 Trajectory::poseAtOffset(double seconds) const {
  SE3 pose = T_building_body_(seconds);
  for (const Ride& ride : rides_) {
    const double share = (seconds - ride.leaves_s) / (ride.arrives_s - ride.leaves_s);
    pose.translation.z() += std::clamp(share, 0.0, 1.0) * (ride.to_m - ride.from_m);
  }
  return pose;
}

SE3 Trajectory::seenPoseAtOffset(double seconds) const {
  SE3 pose = T_building_body_(seconds);
  for (const Ride& ride : rides_)
    if (seconds >= ride.middle_s()) pose.translation.z() += ride.to_m - ride.from_m;
  return pose;
}

Trajectory Trajectory::still(Time start, Duration duration, const SE3& T_building_body) {
  return {start, duration, [T_building_body](double) { return T_building_body; }};
}

Trajectory Trajectory::constantTwist(Time start, Duration duration, const SE3& T_start,
                                     const Vector6d& twist_body) {
  return {start, duration,
          [T_start, twist_body](double seconds) { return T_start * se3Exp(seconds * twist_body); }};
}

}  // namespace sgraphs::simulate
