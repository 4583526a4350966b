#include "perception/odometry/odometry.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/perception/odometry/simulated_walk.h"

namespace sgraphs {
namespace {

using namespace testing_support;

// The estimate's motion since the first scan against the truth's, at the walk's end [m].
double endError(const OdometryRun& run, const simulate::Trajectory& truth) {
  const OdometryEstimate &first = run.estimates.front(), &last = run.estimates.back();
  const SE3 estimated = first.T_odom_body.inverse() * last.T_odom_body;
  return distance(estimated, truth.poseAt(first.time).inverse() * truth.poseAt(last.time));
}

void expectSameBits(const SE3& a, const SE3& b) {
  EXPECT_EQ(a.translation, b.translation);
  EXPECT_EQ(a.rotation.coeffs(), b.rotation.coeffs());
}

void expectSameBits(const Keyframe& a, const Keyframe& b) {
  expectSameBits(a.T_odom_body, b.T_odom_body);
  EXPECT_EQ(a.up_body, b.up_body);
  ASSERT_EQ(a.points.size(), b.points.size());
  for (size_t i = 0; i < a.points.size(); ++i) {
    ASSERT_EQ(a.points[i].position_body, b.points[i].position_body);
    ASSERT_EQ(a.points[i].count, b.points[i].count);
    ASSERT_EQ(a.points[i].scan, b.points[i].scan);
  }
  ASSERT_EQ(a.relative_poses.size(), b.relative_poses.size());
  for (size_t i = 0; i < a.relative_poses.size(); ++i) {
    expectSameBits(a.relative_poses[i].T_from_to, b.relative_poses[i].T_from_to);
    EXPECT_EQ(a.relative_poses[i].covariance, b.relative_poses[i].covariance);
  }
}

void expectSameBits(const OdometryRun& a, const OdometryRun& b) {
  ASSERT_EQ(a.estimates.size(), b.estimates.size());
  for (size_t i = 0; i < a.estimates.size(); ++i) {
    expectSameBits(a.estimates[i].T_odom_body, b.estimates[i].T_odom_body);
    EXPECT_EQ(a.estimates[i].covariance, b.estimates[i].covariance);
    EXPECT_EQ(a.estimates[i].inlier_share, b.estimates[i].inlier_share);
    EXPECT_EQ(a.estimates[i].is_keyframe, b.estimates[i].is_keyframe);
  }
  ASSERT_EQ(a.keyframes.size(), b.keyframes.size());
  for (size_t i = 0; i < a.keyframes.size(); ++i) expectSameBits(a.keyframes[i], b.keyframes[i]);
}

TEST(OdometryTest, FollowsAWalkToWithinTwoCentimetres) {
  const SimulatedWalk walk = walkThrough(furnishedRoom(), 1);
  const OdometryRun lidar = runOdometry(walk, OdometryMode::kLidar);
  const OdometryRun fused = runOdometry(walk, OdometryMode::kFused);
  ASSERT_EQ(lidar.estimates.size(), walk.scans.size());
  const double lidar_m = trajectoryError(lidar, walk.truth), fused_m = trajectoryError(fused, walk.truth);
  RecordProperty("ate_lidar_mm", std::to_string(1000 * lidar_m));
  RecordProperty("ate_fused_mm", std::to_string(1000 * fused_m));
  std::printf("ATE: lidar %.1f mm, fused %.1f mm\n", 1000 * lidar_m, 1000 * fused_m);
  EXPECT_LT(lidar_m, 0.02);
  EXPECT_LT(fused_m, lidar_m + 0.002);
  EXPECT_LT(endError(lidar, walk.truth), 0.04);
  for (const OdometryEstimate& e : lidar.estimates) {
    EXPECT_FALSE(e.extrapolated);
    EXPECT_EQ(e.num_degenerate, 0);
    EXPECT_TRUE(e.scan == 0 || e.inlier_share > 0.8) << "scan " << e.scan << ": " << e.inlier_share;
  }
}

TEST(OdometryTest, MakesAKeyframePerMetreOrTurnWithLinksToTheOnesBefore) {
  simulate::Scene scene = furnishedRoom();
  scene.path.waypoints.resize(2);
  const SimulatedWalk walk = walkThrough(scene, 2);
  const OdometryRun run = runOdometry(walk, OdometryMode::kLidar);
  ASSERT_GE(run.keyframes.size(), 4u);
  EXPECT_GT(run.keyframes[0].up_sigma_rad, 0);
  for (size_t k = 1; k < run.keyframes.size(); ++k) {
    const Keyframe &before = run.keyframes[k - 1], &keyframe = run.keyframes[k];
    EXPECT_EQ(keyframe.id.value, before.id.value + 1);
    EXPECT_GT(keyframe.time, before.time);
    const double moved_m = distance(before.T_odom_body, keyframe.T_odom_body);
    const double turned_rad = angle(before.T_odom_body, keyframe.T_odom_body);
    EXPECT_TRUE(moved_m >= 1.0 || turned_rad >= 0.6);
    EXPECT_LT(moved_m, 1.15);
    EXPECT_LT(turned_rad, 0.75);
    EXPECT_LT(distance(keyframe.T_keyframe_body.back(), SE3()), 1e-9);
    EXPECT_GT(keyframe.points.size(), 3000u);
    int odometry = 0, neighbour = 0;
    for (const RelativePose& r : keyframe.relative_poses) {
      EXPECT_EQ(r.to, keyframe.id);
      odometry += r.kind == RelativePoseKind::kOdometry;
      neighbour += r.kind == RelativePoseKind::kNeighbour;
    }
    EXPECT_EQ(odometry, 1);
    EXPECT_EQ(neighbour, k == 1 ? 1 : 2);
  }
}

TEST(OdometryTest, EncoderModeIsTheLegsMotion) {
  simulate::Scene scene = furnishedRoom();
  scene.path.waypoints.resize(2);
  const SimulatedWalk walk = walkThrough(scene, 3);
  const OdometryRun run = runOdometry(walk, OdometryMode::kEncoder);
  ASSERT_EQ(run.estimates.size(), walk.scans.size());
  for (const OdometryEstimate& e : run.estimates) {
    const auto sample = std::lower_bound(walk.legs.begin(), walk.legs.end(), e.time,
                                         [](const BodyOdometry& s, Time t) { return s.time < t; });
    ASSERT_NE(sample, walk.legs.begin());
    if (sample == walk.legs.end()) continue;
    const BodyOdometry& a = *(sample - 1);
    const double share = (e.time - a.time).seconds() / (sample->time - a.time).seconds();
    const SE3 legs = interpolate(a.T_odom_body, sample->T_odom_body, share);
    EXPECT_LT(distance(e.T_odom_body, legs), 1e-3);
    EXPECT_LT(angle(e.T_odom_body, legs), 1e-3);
    EXPECT_EQ(e.inlier_share, -1);
  }
  EXPECT_GE(run.keyframes.size(), 4u);
}

TEST(OdometryTest, GivesTheSameBitsAgainAndAtAnyNumberOfThreads) {
  simulate::Scene scene = furnishedRoom();
  scene.path.waypoints.resize(2);
  const SimulatedWalk walk = walkThrough(scene, 4);
  OdometryConfig one, two;
  one.threads = 1;
  two.threads = 2;
  const OdometryRun run = runOdometry(walk, OdometryMode::kFused, one);
  ASSERT_GE(run.keyframes.size(), 3u);
  expectSameBits(run, runOdometry(walk, OdometryMode::kFused, one));
  expectSameBits(run, runOdometry(walk, OdometryMode::kFused, two));
}

TEST(OdometryTest, HeadingOfTheStartAgainstTheWallsDoesNotMatter) {
  simulate::Scene scene = furnishedRoom();
  scene.path.waypoints.resize(2);
  double error_m[2] = {0, 0};
  for (const int i : {0, 1}) {
    scene.path.start_heading_rad = i * std::numbers::pi / 4;
    const SimulatedWalk walk = walkThrough(scene, 5);
    error_m[i] = trajectoryError(runOdometry(walk, OdometryMode::kLidar), walk.truth);
  }
  std::printf("ATE: %.1f mm along the walls, %.1f mm at 45 degrees\n", 1000 * error_m[0], 1000 * error_m[1]);
  EXPECT_LT(error_m[0], 0.015);
  EXPECT_LT(error_m[1], 0.015);
  EXPECT_NEAR(error_m[0], error_m[1], 0.006);
}

TEST(OdometryTest, LidarMayBeMountedTurnedAndTilted) {
  simulate::Scene scene = furnishedRoom();
  scene.path.waypoints.resize(2);
  scene.T_body_lidar = poseOf({0.12, -0.05, 0.31}, 0, 2, 90);
  const SimulatedWalk walk = walkThrough(scene, 6);
  EXPECT_LT(trajectoryError(runOdometry(walk, OdometryMode::kLidar), walk.truth), 0.015);
}

TEST(OdometryTest, WalksThroughADoorBetweenTwoRooms) {
  simulate::Scene scene = simulate::makeBoxRoom(7.0, 4.0, 2.6);
  scene.walls.push_back({{3.5, 0}, {3.5, 4}, 0.1, 0, 2.6});
  scene.doorways.push_back({0, {3.5, 2.2, 0}, 1.0, 2.0});
  scene.path.waypoints = {{{1.2, 1.0}, 0}, {{2.0, 2.2}, 0}, {{5.0, 2.2}, 0}};
  scene.path.start_heading_rad = 0.5;
  scene.path.start_pause_s = 0.5;
  scene.path.end_pause_s = 0.2;
  const SimulatedWalk walk = walkThrough(scene, 7);
  // Hardly a beam meets the floor of so small a room: the prior has to hold the height.
  OdometryConfig config;
  config.registration.vertical_acceleration_sigma_mps2 = 1.5;
  for (const OdometryMode mode : {OdometryMode::kLidar, OdometryMode::kFused}) {
    const double error_m = trajectoryError(runOdometry(walk, mode, config), walk.truth);
    std::printf("ATE through the door: %s %.1f mm\n", toString(mode).c_str(), 1000 * error_m);
    EXPECT_LT(error_m, 0.02);
  }
}

// A corridor whose ends are out of sight: the LiDAR does not see motion along it.
simulate::Scene endlessCorridor() {
  simulate::Scene scene = simulate::makeCorridor(300, 2.0, 2.5);
  scene.path.waypoints = {{{149, 1.0}, 0}, {{152.5, 1.0}, 0}};
  scene.path.start_pause_s = 0.5;
  scene.path.end_pause_s = 0;
  return scene;
}

TEST(OdometryTest, CorridorWithoutEndsHasOneUnseenDirectionAndTheLegsCarryIt) {
  const SimulatedWalk walk = walkThrough(endlessCorridor(), 8, exactLegs());
  // Narrow patches on walls a metre away would have random normals, and seem to see along the corridor.
  OdometryConfig config;
  config.surfels.max_half_columns = 30;
  const OdometryRun run = runOdometry(walk, OdometryMode::kFused, config);
  int one = 0;
  for (const OdometryEstimate& e : run.estimates) {
    one += e.num_degenerate == 1;
    EXPECT_LE(e.num_degenerate, 1);
  }
  EXPECT_GE(one, static_cast<int>(0.95 * static_cast<double>(run.estimates.size() - 1)));
  EXPECT_LT(endError(run, walk.truth), 0.03);
  // The odometry's covariance along the corridor is the legs', not a registration's.
  ASSERT_GE(run.keyframes.size(), 3u);
  for (const RelativePose& r : run.keyframes[2].relative_poses)
    if (r.kind == RelativePoseKind::kOdometry) {
      EXPECT_GT(std::sqrt(r.covariance(0, 0)), 3 * std::sqrt(r.covariance(1, 1)));
    }
}

}  // namespace
}  // namespace sgraphs
