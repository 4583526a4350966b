#include "tools/bench/baselines/scan_odometry.h"

#include <utility>

namespace sgraphs::bench {

bool farFrom(const SE3& keyframe, const SE3& pose, double distance_m, double angle_rad) {
  const SE3 moved = keyframe.inverse() * pose;
  return moved.translation.norm() >= distance_m || so3Log(moved.rotation).norm() >= angle_rad;
}

ScanOdometry::ScanOdometry(std::unique_ptr<ScanRegistration> registration, const ScanOdometryConfig& config)
    : registration_(std::move(registration)), config_(config) {}

SE3 ScanOdometry::step(const Points& points_body, const std::optional<SE3>& T_legs_body) {
  if (!begun_) {
    begun_ = true;
    T_legs_body_ = T_legs_body;
    makeKeyframe(points_body);
    return T_odom_body_;
  }
  const SE3 motion = T_legs_body && T_legs_body_ ? T_legs_body_->inverse() * *T_legs_body : T_previous_body_;
  const SE3 guess = T_odom_keyframe_.inverse() * T_odom_body_ * motion;
  const ScanMatch match = registration_->align(points_body, guess);
  const bool usable = match.converged && match.T_target_source.isFinite();
  failed_matches_ += !usable;
  const SE3 T_odom_body = T_odom_keyframe_ * (usable ? match.T_target_source : guess);
  T_previous_body_ = T_odom_body_.inverse() * T_odom_body;
  T_odom_body_ = T_odom_body;
  T_legs_body_ = T_legs_body;
  if (farFrom(T_odom_keyframe_, T_odom_body_, config_.keyframe_distance_m, config_.keyframe_angle_rad))
    makeKeyframe(points_body);
  return T_odom_body_;
}

void ScanOdometry::makeKeyframe(const Points& points_body) {
  T_odom_keyframe_ = T_odom_body_;
  registration_->setTarget(points_body);
}

}  // namespace sgraphs::bench
