#include "perception/loops/sight.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sgraphs {
namespace {

// The cloud is gathered over a metre of path, and a pixel is 2 degrees wide: what stands at an angle to the
// ray spreads over a range.
constexpr float kAgree_m = 0.20F;
constexpr float kAgreeShare = 0.04F;
constexpr float kConflict_m = 0.50F;
constexpr float kConflictShare = 0.06F;
constexpr int kMinFilled = 5;         // of the nine pixels about a direction, to say that it is seen through
constexpr float kNear_m = 1.0F;       // nearer things shift too much within the metre
constexpr float kViewpoint_m = 0.6F;  // points seen from farther off the keyframe's own place do not count

}  // namespace

Sight::Sight(const Keyframe& keyframe)
    : lidar_body_(keyframe.T_body_lidar.translation.cast<float>()),
      pixels_(static_cast<size_t>(kAzimuths * kElevations)) {
  std::vector<bool> close;
  for (const SE3& T : keyframe.T_keyframe_body)
    close.push_back((T * keyframe.T_body_lidar.translation - keyframe.T_body_lidar.translation).norm() <
                    kViewpoint_m);
  for (const KeyframePoint& p : keyframe.points) {
    if (!close[p.scan]) continue;
    const Eigen::Vector3f ray = p.position_body - lidar_body_;
    const float range = ray.norm();
    const float across = std::hypot(ray.x(), ray.y());
    const auto e =
        static_cast<int>(std::floor(std::atan2(ray.z(), across) / kElevationStep_rad)) + kElevations / 2;
    if (e < 0 || e >= kElevations) continue;
    const float turn = std::atan2(ray.y(), ray.x()) / (2.0F * std::numbers::pi_v<float>)+0.5F;
    const int a = std::min(static_cast<int>(turn * kAzimuths), kAzimuths - 1);
    const auto cm = static_cast<uint16_t>(std::clamp(100.0F * range, 1.0F, 65535.0F));
    Pixel& pixel = pixels_[static_cast<size_t>(e * kAzimuths + a)];
    if (pixel.nearest_cm == 0 || cm < pixel.nearest_cm) pixel.nearest_cm = cm;
    pixel.farthest_cm = std::max(pixel.farthest_cm, cm);
  }
}

const Sight::Pixel& Sight::at(int azimuth, int elevation) const {
  const int a = (azimuth + kAzimuths) % kAzimuths;
  return pixels_[static_cast<size_t>(elevation * kAzimuths + a)];
}

SightCounts Sight::compare(std::span<const PackedPatch> patches, const SE3& T_body_other) const {
  SightCounts counts;
  const Eigen::Matrix3f R = T_body_other.matrix3().cast<float>();
  const Eigen::Vector3f t = T_body_other.translation.cast<float>() - lidar_body_;
  for (const PackedPatch& patch : patches) {
    ++counts.total;
    const Eigen::Vector3f ray = R * patch.mean() + t;
    const float range = ray.norm();
    // What shows us its back is another face than the one we see; a grazing ray says little of either.
    if (range < kNear_m || -ray.dot(R * patch.normal()) < 0.15F * range) continue;
    const float across = std::hypot(ray.x(), ray.y());
    const auto e =
        static_cast<int>(std::floor(std::atan2(ray.z(), across) / kElevationStep_rad)) + kElevations / 2;
    if (e < 0 || e >= kElevations) continue;
    const float turn = std::atan2(ray.y(), ray.x()) / (2.0F * std::numbers::pi_v<float>)+0.5F;
    const auto a = static_cast<int>(turn * kAzimuths);
    const float agree = kAgree_m + kAgreeShare * range;
    const float conflict = kConflict_m + kConflictShare * range;
    int filled = 0, through = 0;
    bool agrees = false, hidden = true;
    for (int de = -1; de <= 1; ++de) {
      if (e + de < 0 || e + de >= kElevations) continue;
      for (int da = -1; da <= 1; ++da) {
        const Pixel& pixel = at(a + da, e + de);
        if (pixel.nearest_cm == 0) continue;
        ++filled;
        const float nearest = 0.01F * pixel.nearest_cm, farthest = 0.01F * pixel.farthest_cm;
        agrees |= std::abs(range - nearest) < agree || std::abs(range - farthest) < agree;
        hidden &= range > farthest;
        through += nearest > range + conflict;
      }
    }
    if (!agrees && (hidden || filled < kMinFilled)) continue;
    ++counts.seen;
    counts.agreeing += agrees;
    counts.conflicting += !agrees && through == filled;
  }
  return counts;
}

}  // namespace sgraphs
