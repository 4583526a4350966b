#include "perception/odometry/legs_motion.h"

#include <algorithm>

namespace sgraphs {
namespace {

constexpr Duration kMaxExtrapolation{200000};

}  // namespace

std::optional<SE3> legsPoseAt(std::span<const BodyOdometry> samples, Time time) {
  if (samples.size() < 2) return std::nullopt;
  auto after = std::lower_bound(samples.begin(), samples.end(), time,
                                [](const BodyOdometry& s, Time t) { return s.time < t; });
  if (after == samples.begin()) {
    if (samples.front().time - time > kMaxExtrapolation) return std::nullopt;
    ++after;
  }
  if (after == samples.end()) {
    if (time - samples.back().time > kMaxExtrapolation) return std::nullopt;
    --after;
  }
  const BodyOdometry& a = *(after - 1);
  const BodyOdometry& b = *after;
  const Duration span = b.time - a.time;
  if (span.us <= 0) return a.T_odom_body;
  return interpolate(a.T_odom_body, b.T_odom_body, (time - a.time).seconds() / span.seconds());
}

Matrix6d legsCovariance(const SE3& motion, const LegsConfig& config) {
  const double distance_m = motion.translation.norm();
  const double angle_rad = so3Log(motion.rotation).norm();
  const double sigma_m = config.sigma_m + config.sigma_per_m * distance_m;
  const double sigma_rad = config.sigma_rad + config.sigma_rad_per_rad * angle_rad;
  Vector6d variance;
  variance << Eigen::Vector3d::Constant(sigma_m * sigma_m), Eigen::Vector3d::Constant(sigma_rad * sigma_rad);
  return variance.asDiagonal();
}

std::optional<std::vector<SE3>> legsMotion(std::span<const BodyOdometry> samples, Time begin, Time end,
                                           int segments) {
  std::vector<SE3> motion;
  std::optional<SE3> previous = legsPoseAt(samples, begin);
  if (!previous) return std::nullopt;
  for (int j = 1; j <= segments; ++j) {
    const Time time = begin + Duration{(end - begin).us * j / segments};
    const std::optional<SE3> pose = legsPoseAt(samples, time);
    if (!pose) return std::nullopt;
    motion.push_back(previous->inverse() * *pose);
    previous = pose;
  }
  return motion;
}

}  // namespace sgraphs
