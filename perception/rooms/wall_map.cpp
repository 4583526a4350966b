#include "perception/rooms/wall_map.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sgraphs {
namespace {

// Walls further off plumb than this (12 degrees) are ramps, roofs or a fault.
constexpr double kUpright = 0.2;  // |normal.z|

}  // namespace

std::optional<Wall> wallOf(const MapPlane& plane) {
  const double horizontal = plane.normal_map.head<2>().norm();
  if (std::abs(plane.normal_map.z()) > kUpright || horizontal < 0.5 || plane.polygon_map.empty()) return {};
  Wall wall;
  wall.id = plane.id;
  wall.normal = plane.normal_map.head<2>() / horizontal;
  wall.d = -wall.normal.dot(plane.centroid_map.head<2>());
  wall.along = {wall.normal.y(), -wall.normal.x()};
  wall.begin_m = wall.bottom_z_m = std::numeric_limits<double>::infinity();
  wall.end_m = wall.top_z_m = -std::numeric_limits<double>::infinity();
  for (const Eigen::Vector3f& corner : plane.polygon_map) {
    const Eigen::Vector3d p = corner.cast<double>();
    const double s = wall.along.dot(p.head<2>());
    wall.begin_m = std::min(wall.begin_m, s);
    wall.end_m = std::max(wall.end_m, s);
    wall.bottom_z_m = std::min(wall.bottom_z_m, p.z());
    wall.top_z_m = std::max(wall.top_z_m, p.z());
  }
  return wall;
}

void WallMap::apply(const MapUpdate& update) {
  for (const MapKeyframe& keyframe : update.keyframes) keyframes_[keyframe.id] = keyframe;
  for (const MapPlane& plane : update.planes) apply(plane);
}

void WallMap::apply(const MapPlane& plane) {
  ++changes_;
  walls_.erase(plane.id);
  level_planes_.erase(plane.id);
  if (plane.merged_into.valid()) {
    merged_[plane.id] = plane.merged_into;
    return;
  }
  if (std::abs(plane.normal_map.z()) > 0.9) level_planes_[plane.id] = plane;
  std::optional<Wall> wall = wallOf(plane);
  if (!wall) return;
  wall->changed = changes_;
  wall->keyframe = static_cast<int64_t>(keyframes_.size());
  walls_[plane.id] = *wall;
}

PlaneId WallMap::resolve(PlaneId id) const {
  // A chain is as long as the planes that were merged, even if a message closed it to a ring.
  for (size_t i = 0; i <= merged_.size(); ++i) {
    const auto next = merged_.find(id);
    if (next == merged_.end()) return id;
    id = next->second;
  }
  return id;
}

bool WallMap::isRecent(const Wall& wall, int window) const {
  return window <= 0 || static_cast<int64_t>(keyframes_.size()) - wall.keyframe < window;
}

}  // namespace sgraphs
