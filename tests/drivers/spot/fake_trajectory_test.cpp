#include "tests/drivers/spot/fake_trajectory.h"

#include <gtest/gtest.h>

#include "common/base/error.h"

namespace sgraphs::test {
namespace {

TEST(FakeTrajectoryTest, PlaysAWalkFromItsStartAndStandsAtItsEnds) {
  const SE3 turned(so3Exp({0, 0, 1}), {1, 0, 0});
  const FakeTrajectory walk({{{5'000'000}, {}}, {{7'000'000}, turned}}, {1'000'000});
  EXPECT_EQ(walk.length(), Duration{2'000'000});
  EXPECT_LT(se3Log(walk.at({2'000'000}).T_odom_body.inverse() * interpolate({}, turned, 0.5)).norm(), 1e-12);
  EXPECT_TRUE(walk.at({0}).T_odom_body.translation.isZero());
  EXPECT_TRUE(walk.at({9'000'000}).T_odom_body.translation.isApprox(turned.translation));
  EXPECT_TRUE(walk.at({9'000'000}).linear_odom_mps.isZero());
}

TEST(FakeTrajectoryTest, VelocityIsThatOfThePosesInOdom) {
  const FakeTrajectory walk(
      {{{0}, {so3Exp({0, 0, 1}), {0, 0, 0}}}, {{1'000'000}, {so3Exp({0, 0, 1.5}), {1, 2, 0}}}}, {0});
  constexpr int64_t kStep_us = 100;
  const FakeMotion motion = walk.at({400'000});
  const Eigen::Vector3d moved =
      walk.at({400'000 + kStep_us}).T_odom_body.translation - motion.T_odom_body.translation;
  EXPECT_LT((moved * (1e6 / kStep_us) - motion.linear_odom_mps).norm(), 1e-3);
  EXPECT_NEAR(motion.angular_odom_radps.z(), 0.5, 1e-9);
}

TEST(FakeTrajectoryTest, OnePoseIsNoWalk) {
  EXPECT_THROW(FakeTrajectory({{{0}, {}}}, {0}), Error);
}

}  // namespace
}  // namespace sgraphs::test
