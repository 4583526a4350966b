#pragma once

#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <vector>

#include "common/types/keyframe.h"
#include "common/types/map_update.h"

namespace sgraphs {

// Axis-aligned boxes, seen by exact rays of a LiDAR that stands 0.8 m over the floor.
struct BoxWorld {
  struct Box {
    Eigen::Vector3d low, high;
  };
  std::vector<Box> boxes;

  static constexpr double kBodyHeight_m = 0.5;

  void add(const Eigen::Vector3d& low, const Eigen::Vector3d& high) { boxes.push_back({low, high}); }

  // Walls 0.2 m thick around the inner faces, a floor and a ceiling 2.6 m above it.
  void addRoom(const Eigen::Vector2d& low, const Eigen::Vector2d& high, double z_m = 0) {
    const double t = 0.2;
    const double top = z_m + 2.6;
    add({low.x() - t, low.y() - t, z_m}, {low.x(), high.y() + t, top});
    add({high.x(), low.y() - t, z_m}, {high.x() + t, high.y() + t, top});
    add({low.x() - t, low.y() - t, z_m}, {high.x() + t, low.y(), top});
    add({low.x() - t, high.y(), z_m}, {high.x() + t, high.y() + t, top});
    add({low.x() - t, low.y() - t, z_m - t}, {high.x() + t, high.y() + t, z_m});
    add({low.x() - t, low.y() - t, top}, {high.x() + t, high.y() + t, top + t});
  }

  // Distance along a unit direction; nothing is hit beyond the world.
  std::optional<double> cast(const Eigen::Vector3d& from, const Eigen::Vector3d& direction) const {
    double nearest = std::numeric_limits<double>::infinity();
    for (const Box& box : boxes) {
      double t0 = 1e-9, t1 = nearest;
      for (int i = 0; i < 3; ++i) {
        double a = (box.low[i] - from[i]) / direction[i], b = (box.high[i] - from[i]) / direction[i];
        if (a > b) std::swap(a, b);
        t0 = std::max(t0, a);
        t1 = std::min(t1, b);
      }
      if (t0 <= t1) nearest = std::min(nearest, t0);
    }
    if (!std::isfinite(nearest)) return std::nullopt;
    return nearest;
  }

  // One revolution of 16 rings, half a degree apart along them.
  Keyframe keyframe(int64_t id, const SE3& T_map_body) const {
    Keyframe k;
    k.id = KeyframeId{id};
    k.T_odom_body = T_map_body;
    k.T_body_lidar.translation = {0.0, 0.0, 0.3};
    k.T_keyframe_body = {SE3{}};
    const SE3 T_map_lidar = T_map_body * k.T_body_lidar;
    for (int ring = 0; ring < 16; ++ring)
      for (int column = 0; column < 720; ++column) {
        const double elevation = (2 * ring - 15) * std::numbers::pi / 180;
        const double azimuth = (column + 0.123) * std::numbers::pi / 360;
        const Eigen::Vector3d direction(std::cos(elevation) * std::cos(azimuth),
                                        std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
        const std::optional<double> range = cast(T_map_lidar.translation, T_map_lidar.rotation * direction);
        if (!range) continue;
        KeyframePoint p;
        p.position_body = (k.T_body_lidar * Eigen::Vector3d(*range * direction)).cast<float>();
        k.points.push_back(p);
      }
    return k;
  }
};

inline SE3 bodyAt(double x, double y, double yaw = 0.1, double z = BoxWorld::kBodyHeight_m) {
  return {so3Exp({0, 0, yaw}), {x, y, z}};
}

inline MapUpdate updateOf(const std::vector<MapKeyframe>& keyframes) {
  MapUpdate update;
  update.keyframes = keyframes;
  if (!keyframes.empty()) update.newest = keyframes.back().id;
  return update;
}

inline MapKeyframe mapKeyframe(int64_t id, const SE3& T_map_body, int64_t floor = 0) {
  return {KeyframeId{id}, FloorId{floor}, Time{}, T_map_body};
}

}  // namespace sgraphs
