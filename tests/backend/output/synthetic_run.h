#pragma once

#include <cmath>
#include <memory>

#include "backend/output/run_outputs.h"

namespace sgraphs::test {

// Of the synthetic storey.
inline constexpr double kFloorZ_m = -0.5;
inline const FloorNode kFloor{{0}, {0, 0}, true, kFloorZ_m};

// A box room seen from a square path: everything about it is known in closed form.
struct BoxRoom {
  Eigen::Vector3d min{-1.0, -1.5, -0.5};  // map's origin is the body, half a metre over the ground
  Eigen::Vector3d max{7.0, 5.5, 2.3};
};

// Distance along the unit direction from a point inside to the room's surface.
inline double distanceToRoom(const BoxRoom& room, const Eigen::Vector3d& from,
                             const Eigen::Vector3d& direction) {
  double distance = INFINITY;
  for (int k = 0; k < 3; ++k) {
    if (direction[k] == 0) continue;
    const double border = direction[k] > 0 ? room.max[k] : room.min[k];
    distance = std::min(distance, (border - from[k]) / direction[k]);
  }
  return distance;
}

// Body pose after `s` metres on a square of 4 m by 3 m, heading along it.
inline SE3 squarePath(double s_m) {
  const double sides[] = {4, 3, 4, 3};
  const Eigen::Vector2d corners[] = {{0, 0}, {4, 0}, {4, 3}, {0, 3}};
  s_m = std::fmod(s_m, 14.0);
  int side = 0;
  while (s_m > sides[side]) s_m -= sides[side++];
  const double yaw = side * M_PI / 2;
  const Eigen::Vector2d p = corners[side] + s_m * Eigen::Vector2d(std::cos(yaw), std::sin(yaw));
  return {Eigen::Quaterniond(Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ())), {p.x(), p.y(), 0}};
}

inline std::shared_ptr<const Keyframe> scanRoom(const BoxRoom& room, const SE3& T_map_body) {
  auto keyframe = std::make_shared<Keyframe>();
  keyframe->T_body_lidar = {Eigen::Quaterniond::Identity(), {0.1, 0, 0.3}};
  keyframe->T_keyframe_body = {SE3{}};
  const SE3 T_map_lidar = T_map_body * keyframe->T_body_lidar;
  for (int elevation_deg = -30; elevation_deg <= 30; elevation_deg += 3)
    for (int azimuth_deg = 0; azimuth_deg < 360; azimuth_deg += 2) {
      const double a = azimuth_deg * M_PI / 180, e = elevation_deg * M_PI / 180;
      const Eigen::Vector3d direction(std::cos(a) * std::cos(e), std::sin(a) * std::cos(e), std::sin(e));
      const double range = distanceToRoom(room, T_map_lidar.translation, T_map_lidar.rotation * direction);
      const Eigen::Vector3d p_body = keyframe->T_body_lidar * Eigen::Vector3d(range * direction);
      keyframe->points.push_back({p_body.cast<float>(), 0, 1});
    }
  return keyframe;
}

struct SyntheticRun {
  BoxRoom room;
  SituationalGraph graph;
  RunRecord record;
};

// 140 scans at 10 Hz, 0.1 m apart; a keyframe each metre. The odometry frame is turned and moved against map,
// so that a mix-up of frames shows.
inline std::unique_ptr<SyntheticRun> makeSyntheticRun() {
  auto run = std::make_unique<SyntheticRun>();
  const SE3 T_odom_map(Eigen::Quaterniond(Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitZ())), {3, -2, 0.5});
  KeyframeId newest;
  for (int i = 0; i < 140; ++i) {
    OdometryEstimate scan;
    scan.time = {1'700'000'000'000'000 + i * 100'000};
    scan.scan = i;
    const SE3 T_map_body = squarePath(0.1 * i);
    scan.T_odom_body = T_odom_map * T_map_body;
    scan.is_keyframe = i % 10 == 0;
    if (scan.is_keyframe) {
      const KeyframeId id{i / 10};
      run->graph.keyframes[id] = {
          id, scan.time, T_map_body, scan.T_odom_body, {}, scanRoom(run->room, T_map_body)};
      if (newest.valid()) {
        const SE3& T_map_before = run->graph.keyframes[newest].T_map_body;
        Matrix6d covariance = Matrix6d::Identity() * 1e-4;
        covariance(0, 5) = covariance(5, 0) = 2e-5;
        run->graph.relative_poses.push_back(
            {id.value,
             {RelativePoseKind::kOdometry, newest, id, T_map_before.inverse() * T_map_body, covariance}});
      }
      newest = id;
    }
    scan.keyframe = newest;
    run->record.scans.push_back(scan);
  }
  run->record.graph = &run->graph;
  run->record.version = "test";
  run->record.duration_s = 13.9;
  return run;
}

}  // namespace sgraphs::test
