#include "tests/perception/odometry/simulated_walk.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <thread>

#include "tools/simulate/building/people.h"

namespace sgraphs::testing_support {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

}  // namespace

SE3 poseOf(const Eigen::Vector3d& xyz, double roll_deg, double pitch_deg, double yaw_deg) {
  return {so3Exp({0, 0, yaw_deg * kDegree}) * so3Exp({0, pitch_deg * kDegree, 0}) *
              so3Exp({roll_deg * kDegree, 0, 0}),
          xyz};
}

double distance(const SE3& a, const SE3& b) {
  return (a.translation - b.translation).norm();
}

double angle(const SE3& a, const SE3& b) {
  return so3Log(a.rotation.conjugate() * b.rotation).norm();
}

std::vector<int32_t> allOf(const LidarScan& scan) {
  std::vector<int32_t> all(scan.points.size());
  std::iota(all.begin(), all.end(), 0);
  return all;
}

std::vector<Surfel> surfelsOf(const LidarScan& scan) {
  return extractSurfels(scan, allOf(scan), SE3(), SurfelConfig(), 1);
}

SurfelMap mapOf(const std::vector<Surfel>& surfels, const SE3& T_map_body) {
  SurfelMap map(RegistrationConfig().cell_m);
  for (const Surfel& s : surfels) map.insert(s, T_map_body, 0.08);
  return map;
}

std::span<const BodyOdometry> SimulatedWalk::legsOf(const LidarScan& scan) const {
  const auto before = [](const BodyOdometry& s, Time t) { return s.time < t; };
  auto first = std::lower_bound(legs.begin(), legs.end(), scan.begin, before);
  if (first != legs.begin() && (first == legs.end() || first->time > scan.begin)) --first;
  auto last = std::lower_bound(legs.begin(), legs.end(), scan.end, before);
  if (last != legs.end()) ++last;
  return {first, last};
}

SimulatedWalk walkThrough(const simulate::Scene& scene, uint64_t seed,
                          const simulate::LegsOdometryModel& legs) {
  const simulate::SimulatedWorld world(scene);
  const simulate::Trajectory truth = simulate::walkAlong(scene.path, scene.start, scene.floors_z_m.front());
  const simulate::SensorSimulator sensor(world.caster, truth, scene.T_body_lidar, scene.sensor, seed,
                                         simulate::People(scene.people, scene.floors_z_m),
                                         simulate::LiftDoors(scene, truth.rides(), scene.floors_z_m.front()));
  SimulatedWalk walk{truth, scene.T_body_lidar, {}, simulate::simulateLegsOdometry(truth, legs, seed)};
  walk.scans.resize(static_cast<size_t>(sensor.numScans()));
  const auto work = [&](size_t first) {
    for (size_t i = first; i < walk.scans.size(); i += 2)
      walk.scans[i] = sensor.scan(static_cast<int64_t>(i));
  };
  std::thread odd(work, 1);
  work(0);
  odd.join();
  return walk;
}

simulate::LegsOdometryModel exactLegs() {
  simulate::LegsOdometryModel exact;
  for (double* error :
       {&exact.scale, &exact.turn_scale, &exact.yaw_bias_rad_per_m, &exact.yaw_walk_rad_per_sqrt_m,
        &exact.slip_m_per_rad, &exact.height_bias_m_per_m, &exact.height_walk_m_per_sqrt_m,
        &exact.tilt_sigma_rad, &exact.white_position_m, &exact.white_rotation_rad})
    *error = 0;
  return exact;
}

simulate::Scene furnishedRoom() {
  simulate::Scene scene = simulate::makeBoxRoom(7.0, 5.0, 2.7);
  scene.boxes.push_back({"cupboard", {0.3, 4.0}, {0.6, 1.6}, 0, 1.9, 0});
  scene.boxes.push_back({"desk", {6.4, 0.6}, {1.2, 0.8}, 0, 0.75, 0.2});
  scene.path.waypoints = {{{1.3, 1.2}, 0}, {{5.2, 2.0}, 0}, {{4.8, 3.9}, 0}};
  scene.path.start_heading_rad = 0.2;
  scene.path.start_pause_s = 0.6;
  scene.path.end_pause_s = 0.3;
  return scene;
}

OdometryRun runOdometry(const SimulatedWalk& walk, OdometryMode mode, const OdometryConfig& config) {
  OdometryRun run;
  Odometry odometry(config, mode, walk.T_body_lidar);
  for (const LidarScan& scan : walk.scans) {
    const auto legs = mode == OdometryMode::kLidar ? std::span<const BodyOdometry>() : walk.legsOf(scan);
    const std::optional<OdometryEstimate> estimate = odometry.step(scan, legs);
    if (!estimate) continue;
    run.estimates.push_back(*estimate);
    if (std::optional<Keyframe> keyframe = odometry.takeKeyframe())
      run.keyframes.push_back(std::move(*keyframe));
  }
  return run;
}

double trajectoryError(const OdometryRun& run, const simulate::Trajectory& truth) {
  const auto n = static_cast<Eigen::Index>(run.estimates.size());
  Eigen::Matrix3Xd estimated(3, n), true_places(3, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const OdometryEstimate& e = run.estimates[static_cast<size_t>(i)];
    estimated.col(i) = e.T_odom_body.translation;
    true_places.col(i) = truth.poseAt(e.time).translation;
  }
  const Eigen::Matrix4d T = Eigen::umeyama(estimated, true_places, false);
  const Eigen::Matrix3Xd aligned =
      (T.topLeftCorner<3, 3>() * estimated).colwise() + Eigen::Vector3d(T.topRightCorner<3, 1>());
  return std::sqrt((aligned - true_places).squaredNorm() / static_cast<double>(n));
}

}  // namespace sgraphs::testing_support
