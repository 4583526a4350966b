#include "perception/free_space/surface_height.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace sgraphs {
namespace {

constexpr double kRadius_m = 6.0;           // floors farther away are seen at a grazing angle
constexpr double kHighestSurface_m = 0.10;  // the surface lies lower below the body than this,
constexpr double kLowestSurface_m = 1.60;   // and not lower than this
constexpr double kBin_m = 0.05;
constexpr size_t kBins = 30;   // (kLowestSurface_m - kHighestSurface_m) / kBin_m
constexpr size_t kStride = 3;  // every third point tells as much as all
constexpr int kMinPoints = 30;
constexpr double kDominant = 0.25;  // of the fullest bin: lower levels than that are no floor
constexpr double kSame_m = 0.12;    // a keyframe on a step or a plank sees other heights
constexpr size_t kRemembered = 15;  // keyframes

}  // namespace

std::optional<double> SurfaceHeight::measure(const Keyframe& keyframe, const Eigen::Vector3d& up_body) {
  const Eigen::Vector3f up = up_body.cast<float>();
  std::array<int, kBins> count{};
  std::vector<float> depths;
  for (size_t i = 0; i < keyframe.points.size(); i += kStride) {
    const KeyframePoint& p = keyframe.points[i];
    const float height = up.dot(p.position_body);
    const float depth = -height;
    if (!(depth > kHighestSurface_m && depth < kLowestSurface_m)) continue;
    if ((p.position_body - height * up).squaredNorm() > kRadius_m * kRadius_m) continue;
    depths.push_back(depth);
    ++count[std::min(static_cast<size_t>((depth - kHighestSurface_m) / kBin_m), kBins - 1)];
  }
  // Two neighbouring bins: the level may lie on their border.
  size_t best = 0;
  auto pair = [&](size_t i) { return count[i] + count[i + 1]; };
  for (size_t i = 0; i + 1 < kBins; ++i)
    if (pair(i) > pair(best)) best = i;
  const int fullest = pair(best);
  for (size_t i = best + 2; i + 1 < kBins; ++i)
    if (pair(i) >= kDominant * fullest && pair(i) >= pair(i - 1) && (i + 2 >= kBins || pair(i) > pair(i + 1)))
      best = i;
  if (pair(best) < kMinPoints) return std::nullopt;
  const double begin = kHighestSurface_m + kBin_m * static_cast<double>(best);
  std::vector<float> level;
  for (const float d : depths)
    if (d >= begin && d < begin + 2 * kBin_m) level.push_back(d);
  const auto middle = level.begin() + static_cast<std::ptrdiff_t>(level.size() / 2);
  std::nth_element(level.begin(), middle, level.end());
  return *middle;
}

double SurfaceHeight::median() const {
  std::vector<double> sorted(recent_m_.begin(), recent_m_.end());
  std::sort(sorted.begin(), sorted.end());
  return sorted[sorted.size() / 2];
}

std::optional<double> SurfaceHeight::step(const Keyframe& keyframe, const SE3& T_map_body) {
  const bool knows_up = keyframe.up_body.allFinite() && std::abs(keyframe.up_body.norm() - 1.0) < 0.01;
  const Eigen::Vector3d up_body =
      knows_up ? keyframe.up_body : T_map_body.rotation.conjugate() * Eigen::Vector3d::UnitZ();
  const std::optional<double> own = measure(keyframe, up_body);
  if (own) {
    recent_m_.push_back(*own);
    if (recent_m_.size() > kRemembered) recent_m_.pop_front();
  }
  if (recent_m_.empty()) return std::nullopt;
  const double usual = median();
  return own && std::abs(*own - usual) < kSame_m ? *own : usual;
}

}  // namespace sgraphs
