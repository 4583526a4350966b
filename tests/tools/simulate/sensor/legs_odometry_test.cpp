#include "tools/simulate/sensor/legs_odometry.h"

#include <gtest/gtest.h>

#include <cmath>

#include "common/geometry/degree.h"
#include "tools/simulate/walk/walk.h"

namespace sgraphs::simulate {
namespace {

Trajectory longWalk() {
  WalkPath path;
  for (int lap = 0; lap < 3; ++lap)
    for (const Eigen::Vector2d& xy : {Eigen::Vector2d(0, 0), {8, 0}, {8, 5}, {0, 5}})
      path.waypoints.push_back({xy, 0});
  return walkAlong(path, Time{1700000000000000}, 0);
}

double lengthOf(const Trajectory& trajectory) {
  double length = 0;
  for (double t = 0; t + 0.02 < trajectory.duration().seconds(); t += 0.02)
    length += (trajectory.poseAtOffset(t + 0.02).translation - trajectory.poseAtOffset(t).translation)
                  .head<2>()
                  .norm();
  return length;
}

// Height of body axis x and of body axis y: pitch and roll whatever the yaw.
Eigen::Vector2d tilt(const SE3& T) {
  return T.matrix3().row(2).head<2>();
}

TEST(LegsOdometryTest, StartsAtTheIdentityAtItsRate) {
  const Trajectory walk = longWalk();
  const auto odometry = simulateLegsOdometry(walk, {}, 1);
  EXPECT_LT(se3Log(odometry.front().T_odom_body).norm(), 1e-9);
  EXPECT_EQ(odometry.front().time, walk.start());
  for (size_t i = 1; i < odometry.size(); ++i) ASSERT_EQ((odometry[i].time - odometry[i - 1].time).us, 20000);
  EXPECT_LE(odometry.back().time, walk.end());
  EXPECT_GT(odometry.back().time, walk.end() - Duration{20000});
}

TEST(LegsOdometryTest, WithoutErrorsItIsTheTruthSeenFromTheStart) {
  const LegsOdometryModel exact{50, 0, 0, 0, 0, 0, 0, 0, 0, 10, 0, 0};
  const Trajectory walk = longWalk();
  const SE3 start = walk.poseAt(walk.start());
  for (const BodyOdometry& sample : simulateLegsOdometry(walk, exact, 1)) {
    const SE3 error = (start.inverse() * walk.poseAt(sample.time)).inverse() * sample.T_odom_body;
    ASSERT_LT(se3Log(error).norm(), 1e-6);
  }
}

TEST(LegsOdometryTest, DriftGrowsWithTheWalkWithinItsFigures) {
  const Trajectory walk = longWalk();
  const SE3 start = walk.poseAt(walk.start());
  const double length = lengthOf(walk);
  ASSERT_GT(length, 50);
  double worst_sum = 0;
  constexpr int kSeeds = 10;
  for (uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const auto odometry = simulateLegsOdometry(walk, {}, seed);
    double worst = 0, tilt_squares = 0;
    for (const BodyOdometry& sample : odometry) {
      const SE3 truth = start.inverse() * walk.poseAt(sample.time);
      worst = std::max(worst, (sample.T_odom_body.translation - truth.translation).norm());
      tilt_squares += (tilt(sample.T_odom_body) - tilt(truth)).squaredNorm() / 2;
    }
    worst_sum += worst;
    EXPECT_LT(worst, 0.06 * length) << seed;
    EXPECT_LT(std::sqrt(tilt_squares / static_cast<double>(odometry.size())), 0.25 * kDegree_rad) << seed;
    // The heading drifts by degrees, not by tens of degrees.
    const SE3 truth = start.inverse() * walk.poseAt(odometry.back().time);
    EXPECT_LT(so3Log(truth.rotation.conjugate() * odometry.back().T_odom_body.rotation).norm(),
              25 * kDegree_rad);
  }
  EXPECT_GT(worst_sum / kSeeds, 0.005 * length);
  EXPECT_LT(worst_sum / kSeeds, 0.03 * length);
}

TEST(LegsOdometryTest, SamplesFollowEachOtherSmoothly) {
  const Trajectory walk = longWalk();
  const auto odometry = simulateLegsOdometry(walk, {}, 2);
  for (size_t i = 1; i < odometry.size(); ++i) {
    const SE3 seen = odometry[i - 1].T_odom_body.inverse() * odometry[i].T_odom_body;
    const SE3 truth = walk.poseAt(odometry[i - 1].time).inverse() * walk.poseAt(odometry[i].time);
    ASSERT_LT((seen.translation - truth.translation).norm(), 0.015) << i;
    ASSERT_LT(so3Log(truth.rotation.conjugate() * seen.rotation).norm(), 0.3 * kDegree_rad) << i;
  }
}

TEST(LegsOdometryTest, StandingDoesNotDrift) {
  const auto still =
      Trajectory::still(Time{0}, Duration{60000000}, SE3(Eigen::Quaterniond::Identity(), {1, 2, 0.5}));
  for (const BodyOdometry& sample : simulateLegsOdometry(still, {}, 4))
    ASSERT_LT(sample.T_odom_body.translation.norm(), 0.005);
}

TEST(LegsOdometryTest, SeedsDecideAndRepeat) {
  const Trajectory walk = longWalk();
  const auto a = simulateLegsOdometry(walk, {}, 7), b = simulateLegsOdometry(walk, {}, 7);
  const auto c = simulateLegsOdometry(walk, {}, 8);
  EXPECT_EQ(a.back().T_odom_body.translation, b.back().T_odom_body.translation);
  EXPECT_NE(a.back().T_odom_body.translation, c.back().T_odom_body.translation);
}

TEST(LegsOdometryTest, ClockOffsetMovesTheStampsAndNothingElse) {
  const Trajectory walk = longWalk();
  LegsOdometryModel late;
  late.clock_offset_s = -0.35;
  const auto a = simulateLegsOdometry(walk, {}, 7), b = simulateLegsOdometry(walk, late, 7);
  ASSERT_EQ(a.size(), b.size());
  for (size_t i = 0; i < a.size(); ++i) {
    ASSERT_EQ((b[i].time - a[i].time).us, -350000);
    ASSERT_EQ(a[i].T_odom_body.translation, b[i].T_odom_body.translation);
  }
}

TEST(LegsOdometryTest, ClimbsWithTheSlopeAndMisjudgesItByTheScale) {
  // 3 m up over 6 m.
  const Trajectory climb(Time{0}, Duration{10000000}, [](double s) {
    return SE3(Eigen::Quaterniond::Identity(), {0.6 * s, 0, 0.3 * s});
  });
  LegsOdometryModel exact{50, 0, 0, 0, 0, 0, 0, 0, 0, 10, 0, 0};
  EXPECT_NEAR(simulateLegsOdometry(climb, exact, 1).back().T_odom_body.translation.z(), 3.0, 1e-6);
  exact.scale = 0.02;
  const Eigen::Vector3d end = simulateLegsOdometry(climb, exact, 1).back().T_odom_body.translation;
  EXPECT_NEAR(std::abs(end.z() - 3.0), 0.06, 1e-6);
  EXPECT_NEAR(end.z() / 3.0, end.x() / 6.0, 1e-6);
}

}  // namespace
}  // namespace sgraphs::simulate
