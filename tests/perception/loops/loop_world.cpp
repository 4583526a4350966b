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

struct DriftedKeyframe {
  Keyframe keyframe;
  SE3 T_map_body;
};

// The walk as a map has it that begins at the truth and errs from step to step.
std::vector<DriftedKeyframe> driftedKeyframes(const LoopWalk& walk, const MapDrift& drift) {
  const double sigma_m = drift.registered ? 0.003 : 0.02;
  const double sigma_rad = drift.registered ? 0.0008 : 0.003;
  std::vector<DriftedKeyframe> out;
  for (size_t i = 0; i < walk.keyframes.size(); ++i) {
    DriftedKeyframe d{walk.keyframes[i], walk.T_building_body[i]};
    if (i > 0) {
      RelativePose r;
      r.from = walk.keyframes[i - 1].id;
      r.to = d.keyframe.id;
      r.T_from_to = walk.T_building_body[i - 1].inverse() * walk.T_building_body[i];
      const double m = r.T_from_to.translation.norm();
      r.T_from_to.rotation = r.T_from_to.rotation * so3Exp({0, 0, drift.yaw_rad_per_m * m});
      r.T_from_to.translation *= 1.0 + drift.scale;
      r.registered = drift.registered;
      r.covariance.setZero();
      r.covariance.diagonal() << Eigen::Vector3d::Constant(sigma_m * sigma_m),
          Eigen::Vector3d::Constant(sigma_rad * sigma_rad);
      d.T_map_body = out.back().T_map_body * r.T_from_to;
      d.keyframe.relative_poses.push_back(r);
    }
    d.keyframe.T_odom_body = d.T_map_body;
    out.push_back(std::move(d));
  }
  return out;
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
    const SE3 T = truth.seenPoseAtOffset(t);
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
                      const std::vector<FloorId>& floors, size_t late_rounds) {
  const size_t idle_rounds = late_rounds + 5;
  const std::vector<DriftedKeyframe> drifted = driftedKeyframes(walk, drift);
  LoopFinder finder(config);
  LoopOutcome outcome;
  const auto floorOf = [&](size_t i) { return floors.empty() ? FloorId{0} : floors[i]; };
  const auto place = [&](size_t i, FloorId floor) {
    return MapKeyframe{drifted[i].keyframe.id, floor, drifted[i].keyframe.time, drifted[i].T_map_body};
  };
  for (size_t round = 0; round < drifted.size() + idle_rounds; ++round) {
    MapUpdate update;
    update.round = static_cast<int64_t>(round);
    update.idle = round >= drifted.size();
    update.newest = drifted[std::min(round, drifted.size() - 1)].keyframe.id;
    if (round >= late_rounds && round - late_rounds < drifted.size())
      update.keyframes.push_back(place(round - late_rounds, floorOf(round - late_rounds)));
    if (!update.idle) update.keyframes.push_back(place(round, floorOf(0)));
    const LoopClosures loops =
        finder.step(update.idle ? std::nullopt : std::optional<Keyframe>(drifted[round].keyframe), update);
    outcome.accepted.insert(outcome.accepted.end(), loops.accepted.begin(), loops.accepted.end());
    outcome.withdrawn.insert(outcome.withdrawn.end(), loops.withdrawn.begin(), loops.withdrawn.end());
    outcome.searching = loops.searching;
  }
  for (size_t i = 0; i < drifted.size(); ++i) {
    const SE3 T_map_true = walk.T_building_body[i];
    outcome.largest_drift_m = std::max(outcome.largest_drift_m,
                                       (T_map_true.translation - drifted[i].T_map_body.translation).norm());
  }
  for (const LoopClosure& loop : outcome.accepted) {
    if (std::count(outcome.withdrawn.begin(), outcome.withdrawn.end(), loop.id) > 0) continue;
    const auto from = static_cast<size_t>(loop.pose.from.value), to = static_cast<size_t>(loop.pose.to.value);
    const SE3 T_true = walk.T_building_body[from].inverse() * walk.T_building_body[to];
    const SE3 error = T_true.inverse() * loop.pose.T_from_to;
    const double m = error.translation.norm();
    const bool wrong = m > 0.3 || angleOf(error) > 0.0873 || floorOf(from) != floorOf(to);
    outcome.false_loops += wrong;
    if (!wrong) outcome.worst_m = std::max(outcome.worst_m, m);
  }
  return outcome;
}

}  // namespace sgraphs::test
