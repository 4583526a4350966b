#include "perception/free_space/keyframe_rays.h"

#include <algorithm>
#include <cmath>

namespace sgraphs {
namespace {

constexpr float kGroup_m = 0.6f;         // viewpoints nearer than this see the same
constexpr size_t kMaxGroups = 16;        // later viewpoints join the last
constexpr float kMaxViewpoint_m = 3.0f;  // body to viewpoint, at most
// Heights over the walking surface between which things stand in the way, body a little tilted.
constexpr double kFloorNoise_m = 0.05;
constexpr double kBandTop_m = 2.1;
constexpr double kEverywhere_m = 1e3;
constexpr float kLowestEnd_m = -2.0f;
constexpr float kHeight_m = 0.2f;  // of the 32 heights that are told apart

// Viewpoint of each scan, and the group it belongs to.
std::vector<int> groupViewpoints(const std::vector<Eigen::Vector3f>& viewpoints) {
  std::vector<int> group;
  std::vector<Eigen::Vector3f> first;
  for (const Eigen::Vector3f& v : viewpoints) {
    size_t g = 0;
    while (g < first.size() && (first[g] - v).norm() > kGroup_m) ++g;
    if (g == first.size() && g < kMaxGroups) first.push_back(v);
    group.push_back(static_cast<int>(std::min(g, kMaxGroups - 1)));
  }
  return group;
}

KeyframeRays::Ray makeRay(const Eigen::Vector3f& end, uint8_t viewpoint, bool is_hit) {
  KeyframeRays::Ray ray;
  for (int i = 0; i < 3; ++i)
    ray.end_cm[static_cast<size_t>(i)] = static_cast<int16_t>(std::lround(100 * end[i]));
  ray.viewpoint = viewpoint;
  ray.is_hit = is_hit;
  return ray;
}

}  // namespace

RayThinner::RayThinner(double cell_m, double max_range_m)
    : cell_m_(static_cast<float>(cell_m)),
      max_range_m_(static_cast<float>(max_range_m)),
      half_(static_cast<int>(std::ceil((max_range_m + kMaxViewpoint_m) / cell_m))) {}

bool RayThinner::isNew(int group, const Eigen::Vector3f& end, bool coarse) {
  int x = static_cast<int>(std::floor(end.x() / cell_m_)) + half_;
  int y = static_cast<int>(std::floor(end.y() / cell_m_)) + half_;
  if (x < 0 || y < 0 || x >= 2 * half_ || y >= 2 * half_) return false;
  if (coarse) {  // one of four cells stands for all
    x &= ~1;
    y &= ~1;
  }
  const int z = std::clamp(static_cast<int>((end.z() - kLowestEnd_m) / kHeight_m), 0, 31);
  const auto g = static_cast<size_t>(group);
  const auto size = static_cast<size_t>(4 * half_ * half_);
  if (g >= ends_.size()) ends_.resize(g + 1);
  if (ends_[g].empty()) ends_[g].assign(size, 0);
  uint32_t& heights = ends_[g][static_cast<size_t>(y * 2 * half_ + x)];
  const uint32_t bit = 1u << z;
  if (heights & bit) return false;
  heights |= bit;
  return true;
}

KeyframeRays RayThinner::thin(const Keyframe& keyframe, std::optional<double> body_height_m) {
  const auto low = static_cast<float>(body_height_m ? kFloorNoise_m - *body_height_m : -kEverywhere_m);
  const auto high = static_cast<float>(body_height_m ? kBandTop_m - *body_height_m : kEverywhere_m);
  KeyframeRays out;
  const size_t scans = std::min<size_t>(keyframe.T_keyframe_body.size(), 256);
  for (size_t i = 0; i < scans; ++i)
    out.viewpoints_body.push_back(
        (keyframe.T_keyframe_body[i] * keyframe.T_body_lidar.translation).cast<float>());
  const std::vector<int> group = groupViewpoints(out.viewpoints_body);
  for (const KeyframePoint& p : keyframe.points) {
    if (p.scan >= scans || !p.position_body.allFinite()) continue;
    const Eigen::Vector3f& viewpoint = out.viewpoints_body[p.scan];
    const Eigen::Vector3f ray = p.position_body - viewpoint;
    const float range = ray.norm();
    const bool is_hit = range <= max_range_m_;
    const Eigen::Vector3f end =
        is_hit ? p.position_body : Eigen::Vector3f(viewpoint + ray * (max_range_m_ / range));
    const bool coarse = !is_hit || end.z() < low || end.z() > high;
    if (isNew(group[p.scan], end, coarse)) out.rays.push_back(makeRay(end, p.scan, is_hit));
  }
  for (std::vector<uint32_t>& ends : ends_) std::fill(ends.begin(), ends.end(), 0u);
  out.rays.shrink_to_fit();
  return out;
}

}  // namespace sgraphs
