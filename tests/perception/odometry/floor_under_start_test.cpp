#include "perception/odometry/floor_under_start.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/perception/odometry/simulated_walk.h"

namespace sgraphs {
namespace {

using namespace testing_support;

// Patches, in body, of one noisy scan in a room of 12 x 10 m with desks beside the robot.
std::vector<Surfel> standingAt(const SE3& T_building_body, uint64_t seed) {
  simulate::Scene scene = simulate::makeBoxRoom(12, 10, 2.8);
  scene.boxes.push_back({"desk", {8.5, 4.0}, {1.6, 0.8}, 0.0, 0.45, 0.3});
  const simulate::SimulatedWorld world(scene);
  const LidarScan scan = simulateScan(world, T_building_body * kMount, simulate::SensorModel(), seed);
  return extractSurfels(scan, allOf(scan), kMount, SurfelConfig(), 1);
}

TEST(FloorUnderStartTest, TiltOfTheBodyIsRecovered) {
  for (const double tilt_deg : {0.0, 2.0, 5.0}) {
    for (const double heading_deg : {0.0, 70.0, 200.0}) {
      const SE3 T = poseOf({5.5, 5, 0.52}, tilt_deg, -0.6 * tilt_deg, heading_deg);
      const std::optional<UpDirection> up = floorUnderStart(standingAt(T, 3));
      ASSERT_TRUE(up) << tilt_deg << " deg, heading " << heading_deg << " deg";
      const Eigen::Vector3d truth = T.rotation.conjugate() * Eigen::Vector3d::UnitZ();
      EXPECT_LT(std::acos(std::min(1.0, up->up_body.dot(truth))), 0.003);
      EXPECT_NEAR(up->up_body.norm(), 1.0, 1e-9);
      EXPECT_GE(up->sigma_rad, 0.005);
      EXPECT_LT(up->sigma_rad, 0.02);
    }
  }
}

TEST(FloorUnderStartTest, SaysNothingWhereNoFloorIsInReach) {
  // On a gallery: the hall's floor lies 4 m below, farther than the lowest beam finds within reach.
  EXPECT_FALSE(floorUnderStart(standingAt(poseOf({5.5, 5, 2.3}, 0, 0, 0), 5)));
  EXPECT_FALSE(floorUnderStart({}));
}

TEST(FloorUnderStartTest, TakesNoCeilingOrWallForAFloor) {
  std::vector<Surfel> without;
  for (const Surfel& s : standingAt(poseOf({5.5, 5, 0.52}, 0, 0, 30), 6))
    if (s.normal.z() < 0.5) without.push_back(s);
  ASSERT_GT(without.size(), 500u);
  EXPECT_FALSE(floorUnderStart(without));
}

}  // namespace
}  // namespace sgraphs
