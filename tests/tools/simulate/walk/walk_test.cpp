#include "tools/simulate/walk/walk.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "common/geometry/degree.h"
#include "tools/simulate/scene/test_worlds.h"
#include "tools/simulate/walk/walk_plan.h"

namespace sgraphs::simulate {
namespace {

WalkPath tour() {
  WalkPath path;
  path.waypoints = {{{0, 0}, 0}, {{3, 0}, 0}, {{3, 3}, 1.0}, {{0, 3.2}, 0}, {{2.5, 2.0}, 0}, {{0, 0.5}, 0}};
  path.start_heading_rad = 2.0;
  return path;
}

double yawOf(const SE3& T) {
  const Eigen::Matrix3d R = T.matrix3();
  return std::atan2(R(1, 0), R(0, 0));
}

TEST(WalkTest, StandsStillAtFirstWithTheStartHeading) {
  const WalkPath path = tour();
  const Trajectory walk = walkAlong(path, Time{1000000}, 0.5);
  for (double t = 0; t < path.start_pause_s - 2 * kKnot_s; t += 0.1) {
    const SE3 T = walk.poseAtOffset(t);
    EXPECT_LT((T.translation - Eigen::Vector3d(0, 0, 0.5 + path.body_height_m)).norm(), 1e-12);
    EXPECT_NEAR(yawOf(T), 2.0, 1e-12);
  }
}

TEST(WalkTest, EndsAtRestOnTheLastWaypoint) {
  const WalkPath path = tour();
  const Trajectory walk = walkAlong(path, Time{0}, 0);
  const SE3 end = walk.poseAt(walk.end());
  EXPECT_LT((end.translation.head<2>() - path.waypoints.back().xy).norm(), 1e-9);
  EXPECT_LT((walk.poseAtOffset(walk.duration().seconds() - 0.5).translation - end.translation).norm(), 1e-9);
}

TEST(WalkTest, PassesEveryWaypointWithinAQuarterMetreAndTheSmoothing) {
  const WalkPath path = tour();
  const Trajectory walk = walkAlong(path, Time{0}, 0);
  for (const Waypoint& waypoint : path.waypoints) {
    double nearest = 1e9;
    for (double t = 0; t < walk.duration().seconds(); t += 0.02)
      nearest = std::min(nearest, (walk.poseAtOffset(t).translation.head<2>() - waypoint.xy).norm());
    EXPECT_LT(nearest, 0.28);
  }
}

TEST(WalkTest, KeepsItsBoundsOfSpeedAccelerationAndYawRate) {
  WalkPath path = tour();
  path.gait = {0, 0, 0, 0, 0, 0};
  const Trajectory walk = walkAlong(path, Time{0}, 0);
  const double h = 1e-3, across = path.speed_mps * path.yaw_rate_rad_s;
  const double bound = std::hypot(path.acceleration_mps2, across);
  double fastest = 0, fastest_turn = 0;
  for (double t = h; t + h < walk.duration().seconds(); t += 0.01) {
    const SE3 a = walk.poseAtOffset(t - h), b = walk.poseAtOffset(t), c = walk.poseAtOffset(t + h);
    const double speed = (c.translation - a.translation).norm() / (2 * h);
    const double acceleration = (c.translation - 2 * b.translation + a.translation).norm() / (h * h);
    const double yaw_rate = std::abs(std::remainder(yawOf(c) - yawOf(a), 2 * M_PI)) / (2 * h);
    EXPECT_LE(speed, path.speed_mps * 1.001) << t;
    EXPECT_LE(acceleration, bound * 1.01) << t;
    EXPECT_LE(yaw_rate, path.yaw_rate_rad_s * 1.001) << t;
    fastest = std::max(fastest, speed);
    fastest_turn = std::max(fastest_turn, yaw_rate);
  }
  // The bounds are used, too.
  EXPECT_GT(fastest, 0.99 * path.speed_mps);
  EXPECT_GT(fastest_turn, 0.9 * path.yaw_rate_rad_s);
}

TEST(WalkTest, SecondDerivativesAreContinuous) {
  const Trajectory walk = walkAlong(tour(), Time{0}, 0);
  // The jerk of the gait (1 cm at 4 Hz) is 160 m/s^3, the spline's at most 2 * 0.9 / kKnot_s: over 2 ms the
  // acceleration may change by 0.4 m/s^2. Only a jump would exceed that at the knots.
  const double h = 1e-3;
  const auto acceleration = [&](double t) {
    return Eigen::Vector3d((walk.poseAtOffset(t + h).translation - 2 * walk.poseAtOffset(t).translation +
                            walk.poseAtOffset(t - h).translation) /
                           (h * h));
  };
  for (int knot = 1; knot * kKnot_s + 0.01 < walk.duration().seconds(); ++knot) {
    const double t = knot * kKnot_s;
    EXPECT_LT((acceleration(t + 1e-3) - acceleration(t - 1e-3)).norm(), 0.4) << t;
  }
}

TEST(WalkTest, GaitSwaysAsStatedWhileWalkingAndFadesAtRest) {
  WalkPath path;
  path.waypoints = {{{0, 0}, 0}, {{10, 0}, 0}};
  const Trajectory walk = walkAlong(path, Time{0}, 0);
  double low = 1e9, high = -1e9, roll = 0, pitch = 0;
  for (double t = 6; t < 12; t += 0.005) {
    const SE3 T = walk.poseAtOffset(t);
    const Eigen::Matrix3d R = T.matrix3();
    low = std::min(low, T.translation.z());
    high = std::max(high, T.translation.z());
    roll = std::max(roll, std::atan2(R(2, 1), R(2, 2)));
    pitch = std::max(pitch, std::asin(-R(2, 0)));
  }
  EXPECT_NEAR(high - low, 2 * path.gait.bob_m, 2e-4);
  EXPECT_NEAR(roll, 1.0 * kDegree_rad, 0.02 * kDegree_rad);
  EXPECT_NEAR(pitch, 0.5 * kDegree_rad, 0.02 * kDegree_rad);
  EXPECT_NEAR(walk.poseAt(walk.end()).translation.z(), path.body_height_m, 1e-12);
}

TEST(WalkTest, SharpCornersAreTurnedOnTheSpot) {
  WalkPath path;
  path.waypoints = {{{0, 0}, 0}, {{3, 0}, 0}, {{0, 0.1}, 0}};
  const WalkPlan plan(path);
  double turned_here = 0;
  for (double t = 0; t + 0.01 < plan.duration(); t += 0.01)
    if ((plan.at(t).xy - Eigen::Vector2d(3, 0)).norm() < 1e-6)
      turned_here += std::abs(plan.at(t + 0.01).yaw_rad - plan.at(t).yaw_rad);
  EXPECT_GT(turned_here, 3.0);
}

TEST(WalkTest, PausesAreStoodOut) {
  WalkPath path;
  path.waypoints = {{{0, 0}, 0}, {{3, 0}, 4.0}, {{6, 0}, 0}};
  const WalkPlan with(path);
  path.waypoints[1].pause_s = 0;
  const WalkPlan without(path);
  // The pause, and the time lost in stopping and starting: half of the speed over the ramps.
  EXPECT_NEAR(with.duration() - without.duration(), 4.0 + path.speed_mps / path.acceleration_mps2, 0.05);
}

// Two legs on the flat, a slope of 0.5 over 6 m between, and a way down again.
WalkPath hill() {
  WalkPath path;
  path.gait = {0, 0, 0, 0, 0, 0};
  path.waypoints = {{{0, 0}, 0},     {{4, 0}, 0, 0},    {{10, 0}, 0, 3},
                    {{14, 0}, 0, 3}, {{14, 4}, 0.5, 3}, {{14, 10}, 0, 0.5}};
  return path;
}

TEST(WalkTest, HeightRisesEvenlyWithTheDistanceAndTheBodyPitchesAlong) {
  const WalkPath path = hill();
  const Trajectory walk = walkAlong(path, Time{0}, 1.0);
  int flat = 0, slope = 0, down = 0;
  for (double t = 0; t < walk.duration().seconds(); t += 0.01) {
    const SE3 T = walk.poseAtOffset(t);
    const double x = T.translation.x(), y = T.translation.y(),
                 z = T.translation.z() - 1.0 - path.body_height_m;
    const Eigen::Vector3d forward = T.matrix3().col(0);
    if (x < 3 || (x > 11 && y < 2.5)) {
      EXPECT_NEAR(z, x < 3 ? 0 : 3, 1e-9) << t;
      EXPECT_NEAR(forward.z(), 0, 1e-9) << t;
      ++flat;
    } else if (x > 5 && x < 9) {
      EXPECT_NEAR(z, 0.5 * (x - 4), 1e-9) << t;
      EXPECT_NEAR(forward.z() / forward.x(), 0.5, 1e-9) << t;
      ++slope;
    } else if (y > 5 && y < 9) {
      EXPECT_NEAR(z, 3 - 2.5 / 6 * (y - 4), 1e-9) << t;
      EXPECT_NEAR(forward.z() / forward.y(), -2.5 / 6, 1e-9) << t;
      ++down;
    }
  }
  EXPECT_GT(std::min({flat, slope, down}), 300);
  EXPECT_NEAR(walk.poseAt(walk.end()).translation.z(), 1.0 + path.body_height_m + 0.5, 1e-9);
}

TEST(WalkTest, SlopesAreWalkedAtTheSpeedAlongThem) {
  const WalkPath path = hill();
  const Trajectory walk = walkAlong(path, Time{0}, 0);
  double fastest = 0;
  for (double t = 0.01; t < walk.duration().seconds(); t += 0.01) {
    const double speed =
        (walk.poseAtOffset(t).translation - walk.poseAtOffset(t - 0.01).translation).norm() / 0.01;
    EXPECT_LE(speed, path.speed_mps * 1.001) << t;
    const double x = walk.poseAtOffset(t).translation.x();
    if (x > 5 && x < 9) fastest = std::max(fastest, speed);
  }
  EXPECT_GT(fastest, 0.99 * path.speed_mps);
}

TEST(WalkTest, RiseAndPitchAreSmooth) {
  const Trajectory walk = walkAlong(hill(), Time{0}, 0);
  const double h = 1e-3;
  const auto pitch = [&](double t) { return std::asin(walk.poseAtOffset(t).matrix3()(2, 0)); };
  const auto second = [&](const auto& f, double t) { return (f(t + h) - 2 * f(t) + f(t - h)) / (h * h); };
  const auto height = [&](double t) { return walk.poseAtOffset(t).translation.z(); };
  double steepest_turn = 0;
  for (int knot = 1; knot * kKnot_s + 0.01 < walk.duration().seconds(); ++knot) {
    const double t = knot * kKnot_s;
    EXPECT_LT(std::abs(second(height, t + 1e-3) - second(height, t - 1e-3)), 0.1) << t;
    EXPECT_LT(std::abs(second(pitch, t + 1e-3) - second(pitch, t - 1e-3)), 0.1) << t;
    steepest_turn = std::max(steepest_turn, std::abs(pitch(t + h) - pitch(t - h)) / (2 * h));
  }
  // Fore feet and hind feet come to the slope one after the other: 0.6 m apart at 0.8 m/s.
  EXPECT_LT(steepest_turn, 0.5 / 0.6 * 0.8);
  EXPECT_GT(steepest_turn, 0.3);
}

TEST(WalkTest, StairsAreClimbedWithTheBodyOverTheSteps) {
  const Scene scene = makeTwoStoreys();
  const Stairs& stairs = scene.stairs[0];
  const Trajectory walk = walkAlong(scene.path, Time{0}, 0);
  const double riser = 3.0 / stairs.steps, tread = 4.8 / stairs.steps;
  int over_steps = 0;
  for (double t = 0; t < walk.duration().seconds(); t += 0.01) {
    const Eigen::Vector3d p = walk.poseAtOffset(t).translation;
    const double along = p.x() - stairs.foot.x();
    if (along <= 0 || along >= 4.8 || std::abs(p.y() - 1) > 0.6) continue;
    // The walking surface joins the steps' back edges: it lies by up to a riser under the step.
    const double step_z = riser * (std::floor(along / tread) + 1);
    const double over = p.z() - step_z - scene.path.body_height_m;
    EXPECT_LT(over, 0.05) << t;
    EXPECT_GT(over, -riser - 0.05) << t;
    ++over_steps;
  }
  EXPECT_GT(over_steps, 500);
  EXPECT_NEAR(walk.poseAt(walk.end()).translation.z(), 3 + scene.path.body_height_m, 1e-9);
}

TEST(RiseProfileTest, IsStraightBetweenKnotsAndHoldsBeyondThem) {
  RiseProfile profile;
  profile.add(0, 1);
  profile.add(2, 1);
  profile.add(6, 3);
  profile.add(6, 9);  // left out
  EXPECT_EQ(profile.at(-1), 1);
  EXPECT_EQ(profile.at(2), 1);
  EXPECT_NEAR(profile.at(3), 1.5, 1e-12);
  EXPECT_EQ(profile.at(7), 3);
  EXPECT_NEAR(profile.slope(4), 0.5, 1e-12);
  EXPECT_NEAR(profile.slope(2), 0.25, 1e-12);  // fore feet on the slope, hind feet on the flat
  EXPECT_NEAR(profile.slope(6), 0.25, 1e-12);
  EXPECT_EQ(profile.slope(8), 0);
}

TEST(TrajectoryTest, ConstantTwistIsTheExponential) {
  Vector6d twist;
  twist << 0.5, -0.1, 0.02, 0.1, -0.2, 0.6;
  const SE3 start(so3Exp({0.1, 0.2, 0.3}), {1, 2, 3});
  const auto trajectory = Trajectory::constantTwist(Time{5000000}, Duration{1000000}, start, twist);
  const SE3 expected = start * se3Exp(0.25 * twist);
  EXPECT_LT(se3Log(expected.inverse() * trajectory.poseAt(Time{5250000})).norm(), 1e-12);
  EXPECT_EQ(trajectory.end().us, 6000000);
}

TEST(WalkTest, ALiftRaisesTheBodyAndNoFootFeelsIt) {
  WalkPath path = tour();
  path.waypoints[2].lift = 0;
  path.waypoints[2].ride_m = 3.2;
  for (size_t i = 3; i < path.waypoints.size(); ++i) path.waypoints[i].ridden_m = 3.2;
  const Trajectory walk = walkAlong(path, Time{0}, 0);
  ASSERT_EQ(walk.rides().size(), 1u);
  const Ride& ride = walk.rides().front();
  EXPECT_NEAR(ride.arrives_s - ride.leaves_s, 3.2 / kRide_mps + kRideStart_s, 1e-12);
  const auto heights = [&](double s) {
    return std::array<double, 3>{walk.poseAtOffset(s).translation.z(),
                                 walk.seenPoseAtOffset(s).translation.z(),
                                 walk.feltPoseAt(Time{std::llround(s * 1e6)}).translation.z()};
  };
  const double body = heights(ride.leaves_s)[2];
  for (double s = ride.leaves_s; s < ride.arrives_s; s += 0.1) {
    s = std::round(s * 1e6) * 1e-6;
    const auto [truth, seen, felt] = heights(s);
    EXPECT_NEAR(felt, body, 1e-9) << "it stands";
    EXPECT_NEAR(truth - felt,
                3.2 * std::clamp((s - ride.leaves_s) / (ride.arrives_s - ride.leaves_s), 0.0, 1.0), 1e-9);
    EXPECT_NEAR(seen - felt, s < ride.middle_s() ? 0 : 3.2, 1e-9);
  }
  EXPECT_NEAR(heights(walk.duration().seconds())[0], path.body_height_m + 3.2, 1e-9);
}

}  // namespace
}  // namespace sgraphs::simulate
