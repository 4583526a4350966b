#include "perception/odometry/clock_offset.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "common/geometry/se3.h"

namespace sgraphs {
namespace {

constexpr int64_t kStart_us = 1'700'000'000'000'000;

SE3 turnedBy(double yaw_rad) {
  SE3 T;
  T.rotation = Eigen::Quaterniond(Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ()));
  return T;
}

// A robot that turns now and then, seen by a LiDAR at 10 Hz and by legs at 50 Hz with a clock of their own.
struct Walk {
  double offset_s = 0;
  double legs_scale = 1.0;
  double legs_sigma_rad = 0.0003, lidar_sigma_rad = 0.0005;
  double turn_rad = 1.0;  // size of the turns; 0: straight on
  double duration_s = 60;
  double legs_ahead_s = 0.05;  // how far the legs' samples arrive ahead of the scans
  unsigned seed = 1;

  // Turns of 1.5 s, one each 5 s, to either side.
  double yaw(double t_s) const {
    const double k = std::floor(t_s / 5), in_s = std::fmod(t_s, 5.0);
    const double share = in_s < 1.5 ? 0.5 - 0.5 * std::cos(M_PI * in_s / 1.5) : 1.0;
    const auto turn = [&](double n) { return std::fmod(n, 3) < 1.5 ? turn_rad : -turn_rad; };
    double sum = turn(k) * share;
    for (double n = 0; n < k; ++n) sum += turn(n);
    return sum;
  }

  // What the estimator holds after the walk. The scans' times drift through the samples'.
  ClockOffset run(const ClockOffsetConfig& config = {}) const {
    ClockOffset clock(config);
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    double next_legs_s = 0;
    for (int s = 1; s * 0.1003 < duration_s; ++s) {
      const double t_s = s * 0.1003;
      for (; next_legs_s <= t_s + legs_ahead_s + std::abs(offset_s); next_legs_s += 0.02) {
        const double yaw_rad = legs_scale * yaw(next_legs_s) + legs_sigma_rad * normal(random);
        clock.addLegs({timeOf(next_legs_s + offset_s), turnedBy(yaw_rad)});
      }
      clock.addScan(timeOf(t_s), turnedBy(yaw(t_s) + lidar_sigma_rad * normal(random)), true);
    }
    return clock;
  }
  static Time timeOf(double s) { return Time{kStart_us + std::llround(1e6 * s)}; }
};

TEST(ClockOffsetTest, FindsOffsetsToAMillisecondAndUsesThem) {
  for (const double offset_s : {-0.2, -0.05, -0.013, 0.05, 0.055, 0.2}) {
    Walk walk;
    walk.offset_s = offset_s;
    const ClockOffset clock = walk.run();
    ASSERT_TRUE(clock.estimate()) << offset_s;
    EXPECT_NEAR(clock.estimate()->offset_s, offset_s, 0.001);
    EXPECT_NEAR(clock.inForce().seconds(), offset_s, 0.004);
  }
}

// Here poses err independently, which leaves less error than sigma says, but not by more than this.
TEST(ClockOffsetTest, IsAtLeastAsGoodAsItSays) {
  double sum = 0;
  constexpr int kRuns = 40;
  for (int i = 0; i < kRuns; ++i) {
    Walk walk;
    walk.seed = static_cast<unsigned>(i);
    walk.offset_s = 0.001 * i - 0.02;
    walk.lidar_sigma_rad = 0.002;
    walk.duration_s = 30;
    const auto estimate = walk.run().estimate();
    ASSERT_TRUE(estimate);
    const double z = (estimate->offset_s - walk.offset_s) / estimate->sigma_s;
    sum += z * z;
  }
  EXPECT_GT(sum / kRuns, 0.05);
  EXPECT_LT(sum / kRuns, 1.0);
}

TEST(ClockOffsetTest, ARightClockIsLeftAlone) {
  for (unsigned seed = 0; seed < 10; ++seed) {
    Walk walk;
    walk.seed = seed;
    const ClockOffset clock = walk.run();
    ASSERT_TRUE(clock.estimate());
    EXPECT_LT(std::abs(clock.estimate()->offset_s), 0.001);
    EXPECT_EQ(clock.inForce().us, 0);
  }
}

// A lag that lies between samples averages their noise; it must not win by that.
TEST(ClockOffsetTest, NoisyLegsBiasNothing) {
  double sum = 0;
  for (unsigned seed = 0; seed < 20; ++seed) {
    Walk walk;
    walk.seed = seed;
    walk.legs_sigma_rad = 0.004;
    const auto estimate = walk.run().estimate();
    ASSERT_TRUE(estimate);
    sum += estimate->offset_s;
  }
  EXPECT_LT(std::abs(sum / 20), 0.0015);
}

TEST(ClockOffsetTest, LegsThatTurnTooFarByAScaleAreNoHindrance) {
  Walk walk;
  walk.legs_scale = 1.1;
  walk.offset_s = 0.03;
  const auto estimate = walk.run().estimate();
  ASSERT_TRUE(estimate);
  EXPECT_NEAR(estimate->offset_s, 0.03, 0.001);
}

TEST(ClockOffsetTest, AStraightWalkSaysNothing) {
  Walk walk;
  walk.turn_rad = 0;
  walk.offset_s = 0.05;
  const ClockOffset clock = walk.run();
  EXPECT_FALSE(clock.estimate());
  EXPECT_EQ(clock.inForce().us, 0);
}

TEST(ClockOffsetTest, AnOffsetOutsideTheRangeIsNotMistakenForOneInside) {
  Walk walk;
  walk.offset_s = 0.6;
  EXPECT_EQ(walk.run().inForce().us, 0);
  ClockOffsetConfig wide;
  wide.max_offset_s = 1.0;
  EXPECT_NEAR(walk.run(wide).inForce().seconds(), 0.6, 0.004);
}

// Processes race: samples may have arrived far ahead of the scans, or just in time.
TEST(ClockOffsetTest, HowEarlyTheSamplesArriveChangesNothing) {
  Walk just, early;
  just.offset_s = early.offset_s = -0.05;
  just.lidar_sigma_rad = early.lidar_sigma_rad = 0;
  just.legs_sigma_rad = early.legs_sigma_rad = 0;
  early.legs_ahead_s = 20;
  just.duration_s = early.duration_s = 40;
  const ClockOffset a = just.run(), b = early.run();
  EXPECT_EQ(a.estimate()->offset_s, b.estimate()->offset_s);
  EXPECT_EQ(a.inForce().us, b.inForce().us);
}

TEST(ClockOffsetTest, MissingSamplesAndLostScansAreLeftOut) {
  ClockOffset clock(ClockOffsetConfig{});
  Walk walk;
  walk.offset_s = 0.04;
  double next_legs_s = 0;
  for (int s = 1; s < 900; ++s) {
    const double t_s = s * 0.1003;
    for (; next_legs_s <= t_s + 0.1; next_legs_s += 0.02) {
      const bool missing = std::fmod(next_legs_s, 7) < 1.2;
      if (!missing) clock.addLegs({Walk::timeOf(next_legs_s + 0.04), turnedBy(walk.yaw(next_legs_s))});
    }
    if (s % 40 < 3) continue;
    // Where the LiDAR did not register, its turn is anything.
    const bool registered = s % 50 > 5;
    clock.addScan(Walk::timeOf(t_s), turnedBy(registered ? walk.yaw(t_s) : 1.7), registered);
  }
  ASSERT_TRUE(clock.estimate());
  EXPECT_NEAR(clock.estimate()->offset_s, 0.04, 0.001);
}

TEST(ClockOffsetTest, SwitchedOffItHoldsNothing) {
  ClockOffsetConfig config;
  config.estimate = false;
  Walk walk;
  walk.offset_s = 0.05;
  const ClockOffset clock = walk.run(config);
  EXPECT_FALSE(clock.estimate());
  EXPECT_EQ(clock.inForce().us, 0);
}

}  // namespace
}  // namespace sgraphs
