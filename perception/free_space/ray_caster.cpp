#include "perception/free_space/ray_caster.h"

#include <algorithm>
#include <cmath>

namespace sgraphs {
namespace {

constexpr double kViewMargin_m = 3.5;  // body to viewpoint and a few cells
constexpr float kStandOff = 0.5f;      // cells before a hit that the ray does not clear: ranges are noisy
constexpr float kMinChord = 0.3f;      // cells: a ray that only clips a corner has not seen the cell
constexpr double kBodyRadius_m = 0.2;
constexpr float kHuge = 1e30f;

}  // namespace

RayCaster::RayCaster(double cell_m, double max_range_m, double slice_m) : cell_m_(cell_m), slice_m_(slice_m) {
  view_.size = 2 * static_cast<int>(std::ceil((max_range_m + kViewMargin_m) / cell_m));
}

bool RayCaster::inside(const Eigen::Vector3f& p) const {
  const auto end = static_cast<float>(view_.size - 1);
  return p.x() >= 1 && p.y() >= 1 && p.x() < end && p.y() < end;  // false for NaN
}

const KeyframeView& RayCaster::cast(const KeyframeRays& rays, const SE3& T_map_body, double surface_z_m) {
  const auto cells = static_cast<size_t>(view_.size) * static_cast<size_t>(view_.size);
  view_.hits.assign(cells, 0);
  view_.misses.assign(cells, 0);
  view_.walked.assign(cells, 0);
  view_.x0 = static_cast<int>(std::floor(T_map_body.translation.x() / cell_m_)) - view_.size / 2;
  view_.y0 = static_cast<int>(std::floor(T_map_body.translation.y() / cell_m_)) - view_.size / 2;
  // From body [m] to window cells and slices, in float: the window is small.
  const Eigen::Vector3d scale(1 / cell_m_, 1 / cell_m_, 1 / slice_m_);
  const Eigen::Vector3d shift(view_.x0, view_.y0, (surface_z_m + kLowestSlice_m) / slice_m_);
  const Eigen::Matrix3f R = (scale.asDiagonal() * T_map_body.matrix3()).cast<float>();
  const Eigen::Vector3f t = (scale.cwiseProduct(T_map_body.translation) - shift).cast<float>();
  std::vector<Eigen::Vector3f> viewpoints;
  for (const Eigen::Vector3f& v : rays.viewpoints_body) viewpoints.push_back(R * v + t);
  for (const KeyframeRays::Ray& ray : rays.rays) {
    const Eigen::Vector3f end_body(0.01f * ray.end_cm[0], 0.01f * ray.end_cm[1], 0.01f * ray.end_cm[2]);
    castRay(viewpoints[ray.viewpoint], R * end_body + t, ray.is_hit);
  }
  for (const Eigen::Vector3f& v : viewpoints) markWalked(v);
  for (size_t i = 0; i < cells; ++i) view_.misses[i] &= static_cast<uint16_t>(~view_.hits[i]);
  return view_;
}

void RayCaster::castRay(const Eigen::Vector3f& from, const Eigen::Vector3f& to, bool is_hit) {
  if (!inside(from) || !inside(to)) return;
  const Eigen::Vector3f direction = to - from;
  const float length = direction.head<2>().norm();
  float t = 0, t_end = 1;
  // The part of the ray within the slices.
  const float dz = direction.z();
  if (std::abs(dz) < 1e-6f) {
    if (from.z() < 0 || from.z() >= kNumSlices) return;
  } else {
    const float t_bottom = -from.z() / dz, t_top = (kNumSlices - from.z()) / dz;
    t = std::max(t, std::min(t_bottom, t_top));
    t_end = std::min(t_end, std::max(t_bottom, t_top));
  }
  if (is_hit) {
    const auto slice = static_cast<int>(std::floor(to.z()));
    if (slice >= 0 && slice < kNumSlices)
      view_.hits[view_.index(static_cast<int>(to.x()), static_cast<int>(to.y()))] |=
          static_cast<uint16_t>(1u << slice);
    if (length < kStandOff) return;
    t_end = std::min(t_end, 1 - kStandOff / length);
  }
  if (t < t_end) passThrough(from, direction, t, t_end);
}

// Cells in the order in which the ray passes them (Amanatides and Woo, "A fast voxel traversal algorithm for
// ray tracing", 1987).
void RayCaster::passThrough(const Eigen::Vector3f& from, const Eigen::Vector3f& direction, float t,
                            float t_end) {
  const float dx = direction.x(), dy = direction.y();
  const float x = from.x() + t * dx, y = from.y() + t * dy;
  int cell_x = static_cast<int>(x), cell_y = static_cast<int>(y);
  const float step_tx = dx != 0 ? 1 / std::abs(dx) : kHuge;
  const float step_ty = dy != 0 ? 1 / std::abs(dy) : kHuge;
  const int step_x = dx > 0 ? 1 : -1, step_y = dy > 0 ? view_.size : -view_.size;
  float next_x =
      dx != 0 ? t + step_tx * (dx > 0 ? static_cast<float>(cell_x + 1) - x : x - static_cast<float>(cell_x))
              : kHuge;
  float next_y =
      dy != 0 ? t + step_ty * (dy > 0 ? static_cast<float>(cell_y + 1) - y : y - static_cast<float>(cell_y))
              : kHuge;
  const float min_chord = kMinChord / std::max(direction.head<2>().norm(), 1e-6f);
  auto index = static_cast<std::ptrdiff_t>(view_.index(cell_x, cell_y));
  const auto cells = static_cast<std::ptrdiff_t>(view_.misses.size());
  while (t < t_end && index >= 0 && index < cells) {
    const float t_next = std::min(std::min(next_x, next_y), t_end);
    if (t_next - t > min_chord) {
      const auto slice = static_cast<int>(from.z() + 0.5f * (t + t_next) * direction.z());
      view_.misses[static_cast<size_t>(index)] |=
          static_cast<uint16_t>(1u << std::clamp(slice, 0, kNumSlices - 1));
    }
    if (next_x < next_y) {
      index += step_x;
      next_x += step_tx;
    } else {
      index += step_y;
      next_y += step_ty;
    }
    t = t_next;
  }
}

void RayCaster::markWalked(const Eigen::Vector3f& at) {
  const auto radius = static_cast<float>(kBodyRadius_m / cell_m_);
  const int reach = static_cast<int>(std::ceil(radius));
  const int cx = static_cast<int>(at.x()), cy = static_cast<int>(at.y());
  if (!inside(at) || cx < reach || cy < reach || cx + reach >= view_.size || cy + reach >= view_.size) return;
  for (int y = cy - reach; y <= cy + reach; ++y)
    for (int x = cx - reach; x <= cx + reach; ++x) {
      const Eigen::Vector2f d(static_cast<float>(x) + 0.5f - at.x(), static_cast<float>(y) + 0.5f - at.y());
      if (d.squaredNorm() <= radius * radius) view_.walked[view_.index(x, y)] = 1;
    }
}

}  // namespace sgraphs
