#include "tools/eval/ride_heights.h"

#include <gtest/gtest.h>

namespace sgraphs {
namespace {

constexpr double kUp_m = 3.2;

StampedPose poseAtTime(double seconds, double z_m) {
  return {Time{static_cast<int64_t>(seconds * 1e6)}, SE3(Eigen::Quaterniond::Identity(), {seconds, 0, z_m})};
}

// Ten seconds below, a ride of 4 s, ten seconds above, a ride back, ten seconds below. The truth is in
// another frame, 1 m higher; the estimate puts the upper floor at 20 m, and learns of a ride when it has
// ended.
struct TwoRides {
  TwoRides() {
    for (double t = 0; t <= 38; t += 0.1) {
      const double up =
          std::min(1.0, std::max(0.0, (t - 10) / 4)) - std::min(1.0, std::max(0.0, (t - 24) / 4));
      truth.push_back(poseAtTime(t, 1 + kUp_m * up));
      estimate.push_back(poseAtTime(t, t > 14 && t <= 28 ? 20.0 : 0.0));
    }
  }
  std::vector<StampedPose> truth, estimate;
};

TEST(RideHeightsTest, LevelsAreMovedToWhereTheyAre) {
  const TwoRides w;
  const RideHeights rides(w.estimate, w.truth);
  EXPECT_EQ(rides.levels(), 2u);
  EXPECT_NEAR(rides.shiftAt(0), 0, 1e-9) << "the frame is the alignment's matter";
  EXPECT_NEAR(rides.shiftAt(20), kUp_m - 20, 1e-9);
  EXPECT_NEAR(rides.shiftAt(22), kUp_m - 20, 1e-9) << "a ceiling belongs to its floor";
  std::vector<StampedPose> poses = w.estimate;
  rides.correct(poses);
  EXPECT_NEAR(poses[200].pose.translation.z(), kUp_m, 1e-9);
  EXPECT_NEAR(poses[350].pose.translation.z(), 0, 1e-9);
}

TEST(RideHeightsTest, RidesAreNotJudged) {
  const TwoRides w;
  const RideHeights rides(w.estimate, w.truth);
  for (const double riding : {10.5, 12.0, 13.9, 25.0, 27.9})
    EXPECT_TRUE(rides.riding(poseAtTime(riding, 0).time)) << riding;
  for (const double walking : {5.0, 9.9, 14.2, 20.0, 23.9, 28.2, 35.0})
    EXPECT_FALSE(rides.riding(poseAtTime(walking, 0).time)) << walking;
}

TEST(RideHeightsTest, TheGraphFollows) {
  const TwoRides w;
  const RideHeights rides(w.estimate, w.truth);
  EstimatedGraph graph;
  for (const double t : {5.0, 12.0, 20.0})
    graph.keyframes.push_back({poseAtTime(t, 0).time, poseAtTime(t, t > 14 ? 20 : 0).pose, std::nullopt});
  graph.floors.push_back({"f1", {0, 0}, 19.5, false});
  graph.walls.emplace_back();
  graph.walls.back().centroid = {1, 2, 21};
  graph.walls.back().polygon = {{1, 2, 20}, {1, 3, 22}};
  graph.doorways.push_back({"r0", "r1", "f1", {1, 1, 19.5}, 0.9});
  rides.correct(graph);
  ASSERT_EQ(graph.keyframes.size(), 2u) << "one was on the way";
  EXPECT_NEAR(graph.keyframes[1].T_map_body.translation.z(), kUp_m, 1e-9);
  EXPECT_NEAR(*graph.floors[0].z_m, kUp_m - 0.5, 1e-9);
  EXPECT_NEAR(graph.walls[0].centroid.z(), kUp_m + 1, 1e-9);
  EXPECT_NEAR(graph.walls[0].polygon[1].z(), kUp_m + 2, 1e-9);
  EXPECT_NEAR(graph.doorways[0].position.z(), kUp_m - 0.5, 1e-9);
}

// Stairs and noise are no rides: an error of height is judged as one.
TEST(RideHeightsTest, WhatDoesNotJumpIsLeftAsItIs) {
  std::vector<StampedPose> truth, estimate;
  for (double t = 0; t < 20; t += 0.1) {
    truth.push_back(poseAtTime(t, 0.2 * t));
    estimate.push_back(poseAtTime(t, 0.25 * t));
  }
  const RideHeights rides(estimate, truth);
  EXPECT_EQ(rides.levels(), 1u);
  EXPECT_EQ(rides.shiftAt(3), 0);
  EXPECT_FALSE(rides.riding(truth[100].time));
}

}  // namespace
}  // namespace sgraphs
