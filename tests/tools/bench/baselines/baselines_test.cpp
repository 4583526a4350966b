#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numbers>

#include "common/base/error.h"
#include "common/io/ply.h"
#include "common/io/text_file.h"
#include "common/io/tum.h"
#include "tests/support/temp_folder.h"
#include "tests/tools/system/short_log.h"
#include "tools/bench/baselines/keyframe_graph.h"
#include "tools/bench/baselines/point_map.h"
#include "tools/bench/baselines/pose_graph.h"
#include "tools/bench/baselines/run_baseline.h"
#include "tools/bench/baselines/scan_odometry.h"

namespace sgraphs::bench {
namespace {

SE3 planar(double x, double y, double yaw_rad) {
  return {so3Exp({0, 0, yaw_rad}), {x, y, 0}};
}

double distance(const SE3& a, const SE3& b) {
  return (a.inverse() * b).translation.norm();
}

// Walls, floor and a cupboard of a room of 6 x 4 m, as a body at this place sees them: points every 10 cm.
Points roomSeenFrom(const SE3& T_room_body) {
  Points points;
  const SE3 T_body_room = T_room_body.inverse();
  const auto add = [&](double x, double y, double z) {
    points.push_back((T_body_room * Eigen::Vector3d(x, y, z)).cast<float>());
  };
  for (int i = 0; i <= 60; ++i)
    for (int k = 0; k <= 20; ++k) add(0.1 * i, 0, 0.1 * k), add(0.1 * i, 4, 0.1 * k);
  for (int i = 0; i <= 40; ++i)
    for (int k = 0; k <= 20; ++k) add(0, 0.1 * i, 0.1 * k), add(6, 0.1 * i, 0.1 * k);
  for (int i = 0; i <= 60; ++i)
    for (int k = 0; k <= 40; ++k) add(0.1 * i, 0.1 * k, 0);
  for (int i = 0; i <= 10; ++i)
    for (int k = 0; k <= 15; ++k) add(4 + 0.1 * i, 3.2, 0.1 * k), add(4, 3.2 + 0.08 * i, 0.1 * k);
  return points;
}

// A walk of 1.2 m with a turn, in 13 steps.
SE3 poseOfStep(int step) {
  return planar(1.5 + 0.1 * step, 1.5 + 0.02 * step, 0.03 * step);
}

class ScanOdometryTest : public ::testing::TestWithParam<const char*> {
 protected:
  static std::unique_ptr<ScanRegistration> make() {
    return std::string(GetParam()) == "Gicp" ? makeGicp() : makeNdt();
  }
};

TEST_P(ScanOdometryTest, FollowsAWalkThroughARoom) {
  ScanOdometry odometry(make());
  for (int step = 0; step <= 12; ++step) {
    const SE3 truth = poseOfStep(0).inverse() * poseOfStep(step);
    EXPECT_LT(distance(odometry.step(roomSeenFrom(poseOfStep(step))), truth), 0.05) << "step " << step;
  }
  EXPECT_EQ(odometry.failedMatches(), 0);
}

TEST_P(ScanOdometryTest, TakesTheLegsMotionAsItsGuess) {
  // A step of 1.2 m and 0.5 rad, beyond what constant velocity can know after a rest.
  ScanOdometry odometry(make());
  const SE3 from = planar(1.5, 1.5, 0), to = planar(2.7, 1.6, 0.5);
  odometry.step(roomSeenFrom(from), SE3{});
  odometry.step(roomSeenFrom(from), SE3{});
  const SE3 moved = odometry.step(roomSeenFrom(to), from.inverse() * to);
  EXPECT_LT(distance(moved, from.inverse() * to), 0.05);
}

INSTANTIATE_TEST_SUITE_P(Pcl, ScanOdometryTest, ::testing::Values("Gicp", "Ndt"),
                         [](const auto& param_info) { return std::string(param_info.param); });

// The corners and middles of a square of 8 m, walked once, heading along each side, back to the start.
std::vector<SE3> square() {
  std::vector<SE3> poses;
  for (int side = 0; side < 4; ++side)
    for (int k = 0; k < 4; ++k) {
      const SE3 corner =
          planar(side == 1 || side == 2 ? 8 : 0, side >= 2 ? 8 : 0, side * std::numbers::pi / 2);
      poses.push_back(corner * planar(2.0 * k, 0, 0));
    }
  poses.push_back(planar(0, 0, 2 * std::numbers::pi));
  return poses;
}

TEST(PoseGraphTest, ALoopClosesASquareOfDrift) {
  const std::vector<SE3> truth = square();
  const SE3 drift = planar(0.02, 0.01, 0.01);  // of each step
  std::vector<SE3> drifted{truth[0]};
  std::vector<PoseEdge> edges;
  const Matrix6d covariance = Matrix6d::Identity() * 1e-4;
  for (size_t i = 1; i < truth.size(); ++i) {
    const SE3 step = truth[i - 1].inverse() * truth[i] * drift;
    edges.push_back({i - 1, i, step, covariance, false});
    drifted.push_back(drifted.back() * step);
  }
  const double before = distance(drifted.back(), truth.back());
  ASSERT_GT(before, 0.5);
  edges.push_back({0, truth.size() - 1, truth.front().inverse() * truth.back(), covariance * 1e-2, true});
  const std::vector<SE3> poses = optimisePoses(drifted, edges);
  EXPECT_LT(distance(poses.front(), truth.front()), 1e-12) << "the first pose stays";
  EXPECT_LT(distance(poses.back(), truth.back()), 0.02);
  double worst = 0, worst_before = 0;
  for (size_t i = 0; i < truth.size(); ++i) {
    worst = std::max(worst, distance(poses[i], truth[i]));
    worst_before = std::max(worst_before, distance(drifted[i], truth[i]));
  }
  EXPECT_LT(worst, 0.5 * worst_before);
}

TEST(PoseGraphTest, WithoutEdgesNothingMoves) {
  const std::vector<SE3> poses = square();
  EXPECT_EQ(optimisePoses(poses, {}).size(), poses.size());
}

TEST(KeyframeGraphTest, FindsALoopWhereTheWalkComesBackAndMendsIt) {
  // To and fro in a room; the odometry walks 6 % too far on the way back.
  KeyframeGraphConfig config;
  config.loop_min_path_m = 4;
  config.loop_min_interval_m = 2;
  KeyframeGraph graph(config);
  SE3 T_odom_body, before;
  const auto walk = [&](const SE3& to, double scale) {
    SE3 step = before.inverse() * to;
    step.translation *= scale;
    T_odom_body = T_odom_body * step;
    before = to;
    graph.step(T_odom_body, roomSeenFrom(planar(1.2, 1.5, 0) * to));
  };
  for (int k = 0; k <= 3; ++k) walk(planar(1.0 * k, 0, 0), 1.0);
  for (int k = 3; k >= 0; --k) walk(planar(1.0 * k, 0.2, 0), 1.06);
  ASSERT_GE(graph.loops(), 1);
  const SE3 expected = planar(0, 0.2, 0);
  const double odometry_error = distance(T_odom_body, expected);
  EXPECT_GT(odometry_error, 0.15);
  EXPECT_LT(distance(graph.estimates().back(), expected), 0.6 * odometry_error);
}

TEST(FitnessTest, IsTheMeanSquaredDistanceWithinRange) {
  const Points target{{0, 0, 0}, {10, 0, 0}};
  const Points source{{0.1f, 0, 0}, {10, 0.3f, 0}, {5, 0, 0}};
  EXPECT_NEAR(fitness_m2(target, source, SE3{}, 1.0), (0.01 + 0.09) / 2, 1e-6);
  EXPECT_TRUE(std::isinf(fitness_m2(target, {{5, 0, 0}}, SE3{}, 1.0)));
}

TEST(PointMapTest, HoldsOneCentroidPerVoxel) {
  PointMap map(0.1);
  map.add({0.01, 0.01, 0.01});
  map.add({0.03, 0.05, 0.01});
  map.add({-0.01, 0, 0});
  map.add({std::nan(""), 0, 0});
  const auto points = map.points();
  ASSERT_EQ(points.size(), 2u);
  EXPECT_NEAR(points[1].x(), 0.02, 1e-6);
  EXPECT_NEAR(points[1].y(), 0.03, 1e-6);
}

BaselineOptions optionsFor(const test::TempFolder& folder, Baseline baseline) {
  BaselineOptions options;
  options.log = folder / "run.lcmlog";
  options.out_dir = folder / "out";
  options.baseline = baseline;
  return options;
}

TEST(RunBaselineTest, WritesWhatEvalReads) {
  test::TempFolder folder;
  testing::writeShortLog(folder / "run.lcmlog");
  const BaselineReport report = runBaseline(optionsFor(folder, Baseline::kLegs));
  EXPECT_GT(report.scans, 50);
  const auto trajectory = readTum(folder / "out/trajectory.tum");
  ASSERT_EQ(trajectory.size(), static_cast<size_t>(report.scans));
  EXPECT_NEAR(distance(trajectory.front().pose, trajectory.back().pose), 3.0, 0.15) << "a walk of 3 m";
  EXPECT_GT(readPlyPoints(folder / "out/map.ply").points.size(), 5000u);
  const auto summary = nlohmann::json::parse(readFile(folder / "out/summary.json"));
  EXPECT_EQ(summary["baseline"], "legs");
  EXPECT_EQ(summary["stages"]["scan"]["count"], report.scans);
}

TEST(RunBaselineTest, RegistersTheScansOfALog) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "80 registrations take too long under a sanitizer; the room above covers the same code";
#endif
  test::TempFolder folder;
  testing::writeShortLog(folder / "run.lcmlog");
  const BaselineReport report = runBaseline(optionsFor(folder, Baseline::kGraph));
  EXPECT_EQ(report.failed_matches, 0);
  EXPECT_GE(report.keyframes, 3);
  const auto trajectory = readTum(folder / "out/trajectory.tum");
  EXPECT_NEAR(distance(trajectory.front().pose, trajectory.back().pose), 3.01, 0.1);
}

TEST(RunBaselineTest, AWordThatIsNoBaselineIsRefused) {
  EXPECT_THROW(parseBaseline("kiss"), UsageError);
}

}  // namespace
}  // namespace sgraphs::bench
