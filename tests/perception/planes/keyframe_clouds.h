#pragma once

#include <random>
#include <vector>

#include "common/types/keyframe.h"
#include "perception/odometry/keyframe_builder.h"
#include "tests/perception/odometry/simulated_walk.h"

namespace sgraphs::testing_support {

// Keyframe from revolutions of a sensor that stands at each of these places (T_building_body, exactly known).
// The last place is the keyframe's; T_odom_body is T_building_body.
inline Keyframe keyframeAt(const simulate::SimulatedWorld& world, const std::vector<SE3>& places,
                           const simulate::SensorModel& model, uint64_t seed = 1) {
  KeyframeBuilder builder(KeyframeConfig(), world.scene.T_body_lidar);
  for (const SE3& T : places) {
    const LidarScan scan = simulate::simulateScan(world, T * world.scene.T_body_lidar, model, seed++);
    builder.add(scan, allOf(scan), {}, {scan.begin, scan.end, {T, T}});
  }
  std::vector<Surfel> surfels;
  Keyframe keyframe = builder.build(places.back(), surfels);
  keyframe.id = KeyframeId{static_cast<int64_t>(seed)};
  keyframe.time = Time{1'700'000'000'000'000};
  return keyframe;
}

// Places of a walk from a to b, level, 0.1 m apart, with a sway of 1 degree that spreads the rings.
inline std::vector<SE3> walkBetween(const Eigen::Vector3d& a, const Eigen::Vector3d& b, double yaw_deg = 0) {
  std::vector<SE3> places;
  const int steps = std::max(1, static_cast<int>((b - a).norm() / 0.1));
  for (int i = 0; i <= steps; ++i)
    places.push_back(poseOf(a + (b - a) * i / steps, std::sin(1.3 * i), 0.5 * std::cos(2.1 * i), yaw_deg));
  return places;
}

// Points of a rectangle seen from the origin of body: corner, two edges, spacing, noise along the ray.
struct CloudMaker {
  explicit CloudMaker(uint64_t seed = 1) : random(seed) { keyframe.T_keyframe_body = {SE3()}; }

  void addRectangle(const Eigen::Vector3d& corner, const Eigen::Vector3d& edge1, const Eigen::Vector3d& edge2,
                    double noise_m = 0, double spacing_m = 0.05, uint8_t scan = 0) {
    std::normal_distribution<double> normal(0.0, 1.0);
    const SE3 T = keyframe.T_keyframe_body[scan] * keyframe.T_body_lidar;
    const int n1 = static_cast<int>(edge1.norm() / spacing_m),
              n2 = static_cast<int>(edge2.norm() / spacing_m);
    for (int i = 0; i <= n1; ++i)
      for (int j = 0; j <= n2; ++j) {
        const Eigen::Vector3d p = corner + edge1 * i / n1 + edge2 * j / n2;
        const Eigen::Vector3d ray = (p - T.translation).normalized();
        keyframe.points.push_back({(p + noise_m * normal(random) * ray).cast<float>(), scan, 4});
      }
  }

  Keyframe keyframe;
  std::mt19937_64 random;
};

}  // namespace sgraphs::testing_support
