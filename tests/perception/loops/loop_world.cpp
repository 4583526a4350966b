#include "tests/perception/loops/loop_world.h"

#include <algorithm>
#include <cmath>

#include "perception/odometry/voxel_index.h"
#include "tools/simulate/scene/scene_file.h"
#include "tools/simulate/walk/walk.h"

namespace sgraphs::test {
namespace {

constexpr double kVoxel_m = 0.05;
constexpr int kRevolutions = 3;
constexpr double kBetween_m = 0.3;

uint64_t voxelOf(const Eigen::Vector3d& p, const Eigen::Vector3d& viewpoint) {
  const Eigen::Vector3d cell = (p / kVoxel_m).array().floor();
  Eigen::Index axis = 0;
  (p - viewpoint).cwiseAbs().maxCoeff(&axis);
  return VoxelIndex::pack(static_cast<int64_t>(cell.x()), static_cast<int64_t>(cell.y()),
                          static_cast<int64_t>(cell.z()),
                          static_cast<uint64_t>(2 * axis + ((p - viewpoint)[axis] < 0)));
}

double angleOf(const SE3& T) {
  return so3Log(T.rotation).norm();
}

}  // namespace

SE3 bodyAt(double x_m, double y_m, double heading_rad, double floor_z_m) {
  return {so3Exp({0, 0, heading_rad}), {x_m, y_m, floor_z_m + 0.52}};
}

Keyframe keyframeAt(const simulate::SimulatedWorld& world, const SE3& T_building_body, int64_t id,
                    uint64_t seed) {
  simulate::SensorModel model;
  model.rpm = 1200;
  Keyframe k;
  k.id = KeyframeId{id};
  k.time = Time{1'000'000 * (id + 1)};
  k.T_odom_body = T_building_body;
  k.T_body_lidar = world.scene.T_body_lidar;
  VoxelIndex taken;
  for (int i = 0; i < kRevolutions; ++i) {
    // A walking body rolls and pitches by a degree, which spreads the rings.
    const int back = kRevolutions - 1 - i;
    const SE3 T_keyframe_body(so3Exp({0.015 * (back % 2), 0.012 * back, 0}), {-kBetween_m * back, 0, 0});
    k.T_keyframe_body.push_back(T_keyframe_body);
    const SE3 T_keyframe_lidar = T_keyframe_body * k.T_body_lidar;
    const LidarScan scan = simulateScan(world, T_building_body * T_keyframe_lidar, model,
                                        seed * 1'000'003 + static_cast<uint64_t>(id * kRevolutions + i));
    for (const LidarPoint& p : scan.points) {
      const Eigen::Vector3d point = T_keyframe_lidar * p.position_lidar.cast<double>();
      const uint64_t key = voxelOf(point, T_keyframe_lidar.translation);
      if (taken.find(key) >= 0) continue;
      taken.insert(key, 0);
      KeyframePoint out;
      out.position_body = point.cast<float>();
      out.scan = static_cast<uint8_t>(i);
      k.points.push_back(out);
    }
  }
  return k;
}

LoopWalk walkThrough(const simulate::Scene& scene, uint64_t seed, double max_path_m) {
  const simulate::SimulatedWorld world(scene);
  const simulate::Trajectory truth = simulate::walkAlong(
      scene.path, scene.start, scene.floors_z_m.at(static_cast<size_t>(scene.path_floor)));
  LoopWalk walk;
  double walked_m = 0;
  for (double t = 0; t < truth.duration().seconds() && walked_m < max_path_m; t += 0.1) {
    const SE3 T = truth.poseAtOffset(t);
    if (!walk.keyframes.empty()) {
      const SE3 step = walk.T_building_body.back().inverse() * T;
      if (step.translation.norm() < 1.0 && angleOf(step) < 0.6) continue;
      walked_m += step.translation.norm();
    }
    walk.keyframes.push_back(keyframeAt(world, T, static_cast<int64_t>(walk.keyframes.size()), seed));
    walk.T_building_body.push_back(T);
  }
  return walk;
}

simulate::Scene shippedScene(const std::string& name) {
  return simulate::loadScene(SGRAPHS_SOURCE_DIR "/config/scenes/" + name + "/plan.json");
}

LoopOutcome findLoops(const LoopWalk& walk, const MapDrift& drift, const LoopsConfig& config,
                      const std::vector<FloorId>& floors) {
  LoopFinder finder(config);
  LoopOutcome outcome;
  std::vector<MapKeyframe> map;
  const double sigma_m = drift.registered ? 0.003 : 0.02;
  const double sigma_rad = drift.registered ? 0.0008 : 0.003;
  for (size_t i = 0; i < walk.keyframes.size(); ++i) {
    Keyframe k = walk.keyframes[i];
    SE3 T = walk.T_building_body[i];
    if (i > 0) {
      SE3 step = walk.T_building_body[i - 1].inverse() * T;
      step.rotation = step.rotation * so3Exp({0, 0, drift.yaw_rad_per_m * step.translation.norm()});
      step.translation *= 1.0 + drift.scale;
      T = map.back().T_map_body * step;
      RelativePose r;
      r.from = walk.keyframes[i - 1].id;
      r.to = k.id;
      r.T_from_to = step;
      r.registered = drift.registered;
      r.covariance.setZero();
      r.covariance.diagonal() << Eigen::Vector3d::Constant(sigma_m * sigma_m),
          Eigen::Vector3d::Constant(sigma_rad * sigma_rad);
      k.relative_poses.push_back(r);
    }
    k.T_odom_body = T;
    map.push_back({k.id, floors.empty() ? FloorId{0} : floors[i], k.time, T});
    const SE3 T_map_true =
        map.front().T_map_body * walk.T_building_body.front().inverse() * walk.T_building_body[i];
    outcome.largest_drift_m =
        std::max(outcome.largest_drift_m, (T_map_true.translation - T.translation).norm());
    MapUpdate update;
    update.round = static_cast<int64_t>(i);
    update.time = k.time;
    update.newest = k.id;
    update.keyframes.push_back(map.back());
    const LoopClosures loops = finder.step(k, update);
    for (const LoopClosure& loop : loops.accepted) {
      const SE3 T_true = walk.T_building_body[static_cast<size_t>(loop.pose.from.value)].inverse() *
                         walk.T_building_body[static_cast<size_t>(loop.pose.to.value)];
      const SE3 error = T_true.inverse() * loop.pose.T_from_to;
      const double m = error.translation.norm();
      const bool wrong = m > 0.3 || angleOf(error) > 0.0873 ||
                         (!floors.empty() && floors[static_cast<size_t>(loop.pose.from.value)] != floors[i]);
      outcome.false_loops += wrong;
      if (!wrong) outcome.worst_m = std::max(outcome.worst_m, m);
      outcome.accepted.push_back(loop);
    }
    outcome.withdrawn.insert(outcome.withdrawn.end(), loops.withdrawn.begin(), loops.withdrawn.end());
  }
  return outcome;
}

}  // namespace sgraphs::test
