#include "perception/odometry/legs_motion.h"

#include <gtest/gtest.h>

namespace sgraphs {
namespace {

const Vector6d kTwist = (Vector6d() << 0.8, 0.1, -0.05, 0.1, -0.2, 0.6).finished();
const SE3 kStart(so3Exp({0.1, 0.2, -1.0}), {3, -2, 0.5});

SE3 truth(int64_t us) {
  return kStart * se3Exp(static_cast<double>(us) * 1e-6 * kTwist);
}

// 50 Hz from 1 s on.
std::vector<BodyOdometry> samples(int count) {
  std::vector<BodyOdometry> all;
  for (int64_t i = 0; i < count; ++i)
    all.push_back({Time{1'000'000 + 20'000 * i}, truth(1'000'000 + 20'000 * i)});
  return all;
}

void expectSame(const std::optional<SE3>& a, const SE3& b) {
  ASSERT_TRUE(a);
  EXPECT_LT((a->translation - b.translation).norm(), 1e-9);
  EXPECT_LT(a->rotation.angularDistance(b.rotation), 1e-9);
}

TEST(LegsMotionTest, BetweenSamplesTheTwistIsConstant) {
  const auto legs = samples(10);
  for (const int64_t us : {1'000'000, 1'000'001, 1'013'000, 1'060'000, 1'179'999, 1'180'000})
    expectSame(legsPoseAt(legs, Time{us}), truth(us));
}

TEST(LegsMotionTest, ReachesAFifthOfASecondOutsideTheSamplesAndNoFarther) {
  const auto legs = samples(10);
  expectSame(legsPoseAt(legs, Time{1'380'000}), truth(1'380'000));
  EXPECT_FALSE(legsPoseAt(legs, Time{1'380'001}));
  expectSame(legsPoseAt(legs, Time{800'000}), truth(800'000));
  EXPECT_FALSE(legsPoseAt(legs, Time{799'999}));
}

TEST(LegsMotionTest, OneSampleTellsNoMotion) {
  EXPECT_FALSE(legsPoseAt({}, Time{1'000'000}));
  EXPECT_FALSE(legsPoseAt(samples(1), Time{1'000'000}));
  EXPECT_FALSE(legsMotion(samples(1), Time{1'000'000}, Time{1'100'000}, 1));
}

TEST(LegsMotionTest, TwoSamplesOfOneInstantGiveAFinitePose) {
  auto legs = samples(1);
  legs.push_back(legs[0]);
  for (const int64_t us : {999'000, 1'000'000, 1'001'000}) {
    const auto pose = legsPoseAt(legs, Time{us});
    ASSERT_TRUE(pose);
    EXPECT_TRUE(pose->isFinite());
  }
}

TEST(LegsMotionTest, MotionIsBetweenTheKnotsOfAScan) {
  const auto legs = samples(10);
  const auto motion = legsMotion(legs, Time{1'011'000}, Time{1'111'000}, 4);
  ASSERT_TRUE(motion);
  ASSERT_EQ(motion->size(), 4u);
  SE3 total;
  for (const SE3& piece : *motion) {
    expectSame(piece, se3Exp(0.025 * kTwist));
    total = total * piece;
  }
  expectSame(total, se3Exp(0.1 * kTwist));
}

TEST(LegsMotionTest, ScanThatTheSamplesDoNotReachHasNoMotion) {
  EXPECT_FALSE(legsMotion(samples(10), Time{1'300'000}, Time{1'400'000}, 1));
  EXPECT_FALSE(legsMotion(samples(10), Time{700'000}, Time{1'050'000}, 1));
}

TEST(LegsMotionTest, CovarianceGrowsWithDistanceAndRotation) {
  LegsConfig config;
  config.sigma_m = 0.002;
  config.sigma_per_m = 0.05;
  config.sigma_rad = 0.001;
  config.sigma_rad_per_rad = 0.1;
  const Matrix6d still = legsCovariance(SE3(), config);
  EXPECT_NEAR(still(0, 0), 4e-6, 1e-15);
  EXPECT_NEAR(still(5, 5), 1e-6, 1e-15);
  const Matrix6d walked = legsCovariance({so3Exp({0, 0, 0.2}), {0.3, 0.4, 0}}, config);
  EXPECT_NEAR(std::sqrt(walked(1, 1)), 0.002 + 0.05 * 0.5, 1e-12);
  EXPECT_NEAR(std::sqrt(walked(3, 3)), 0.001 + 0.1 * 0.2, 1e-12);
  EXPECT_EQ(walked, Matrix6d(walked.diagonal().asDiagonal()));
}

}  // namespace
}  // namespace sgraphs
