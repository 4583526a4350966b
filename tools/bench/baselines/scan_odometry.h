#pragma once

#include <memory>
#include <optional>

#include "tools/bench/baselines/scan_registration.h"

namespace sgraphs::bench {

struct ScanOdometryConfig {
  double keyframe_distance_m = 0.5;  // from the target, where the next scan becomes the target
  double keyframe_angle_rad = 0.5;
};

// Whether `pose` is this far or this much turned from `keyframe`.
bool farFrom(const SE3& keyframe, const SE3& pose, double distance_m, double angle_rad);

// Scan-to-keyframe odometry as HDL-SLAM has it: each scan is registered to the last keyframe's scan, from a
// guess by constant velocity, or by the legs' motion where it is known. A match that does not converge leaves
// the guess.
class ScanOdometry {
 public:
  ScanOdometry(std::unique_ptr<ScanRegistration> registration, const ScanOdometryConfig& config = {});

  // The next scan's points in body, and the legs' odometry at its end; returns T_odom_body, the first being
  // the identity.
  SE3 step(const Points& points_body, const std::optional<SE3>& T_legs_body = std::nullopt);

  int failedMatches() const { return failed_matches_; }

 private:
  void makeKeyframe(const Points& points_body);

  std::unique_ptr<ScanRegistration> registration_;
  ScanOdometryConfig config_;
  bool begun_ = false;
  SE3 T_odom_keyframe_;
  SE3 T_odom_body_;                 // of the newest scan
  SE3 T_previous_body_;             // the newest scan's motion
  std::optional<SE3> T_legs_body_;  // at the newest scan
  int failed_matches_ = 0;
};

}  // namespace sgraphs::bench
