#include "backend/levelling.h"

#include <gtest/gtest.h>

namespace sgraphs {
namespace {

TEST(LevelledRotationTest, TurnsWhatTheBodySeesAsUpIntoZ) {
  for (const Eigen::Vector3d& up : {Eigen::Vector3d(0.1, -0.2, 0.9), Eigen::Vector3d(-0.5, 0.5, -0.7),
                                    Eigen::Vector3d(0, 1, 0), Eigen::Vector3d(0, 0, 1)}) {
    const Eigen::Vector3d up_body = up.normalized();
    EXPECT_LT((levelledRotation(up_body) * up_body - Eigen::Vector3d::UnitZ()).norm(), 1e-12);
  }
}

TEST(LevelledRotationTest, KeepsTheHeading) {
  const Eigen::Vector3d up_body = Eigen::Vector3d(0.3, -0.2, 0.8).normalized();
  const Eigen::Vector3d forward_map = levelledRotation(up_body) * Eigen::Vector3d::UnitX();
  EXPECT_NEAR(forward_map.y(), 0.0, 1e-12);
  EXPECT_GT(forward_map.x(), 0.0);
}

TEST(LevelledRotationTest, LevelBodyIsNotTurned) {
  EXPECT_EQ(levelledRotation(Eigen::Vector3d::UnitZ()).angularDistance(Eigen::Quaterniond::Identity()), 0.0);
}

// 20 m up as an odometry has it whose vertical is 10 mrad off: 0.2 m aside.
TEST(AlongVerticalTest, TurnsARideToTheMapsVertical) {
  const SE3 T_map_from(so3Exp({0.02, -0.03, 1.2}), {1, 2, 3});
  const Eigen::Vector3d up_body = T_map_from.rotation.conjugate() * Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d assumed = so3Exp({0.01, 0, 0}) * up_body;
  RelativePose ride;
  ride.T_from_to = {so3Exp({0, 0, 0.4}), 20 * assumed + Eigen::Vector3d(0.05, 0, 0)};
  const Eigen::Vector3d open_to = ride.T_from_to.rotation.conjugate() * assumed;
  ride.covariance = 1e-4 * Matrix6d::Identity();
  ride.covariance.topLeftCorner<3, 3>() += 400 * open_to * open_to.transpose();
  ASSERT_TRUE(leavesHeightOpen(ride));
  const RelativePose turned = alongVertical(ride, T_map_from, Eigen::Vector3d::UnitZ());
  const SE3 T_map_to = T_map_from * turned.T_from_to;

  const Eigen::Vector3d moved = T_map_to.translation - T_map_from.translation;
  EXPECT_NEAR(moved.z(), 20, 0.01);
  EXPECT_LT(moved.head<2>().norm(), 0.06);
  EXPECT_EQ(turned.T_from_to.rotation.angularDistance(ride.T_from_to.rotation), 0);
  const Eigen::Matrix3d R = T_map_to.matrix3();
  const Eigen::Matrix3d C = R * turned.covariance.topLeftCorner<3, 3>() * R.transpose();
  EXPECT_NEAR(C(2, 2), 400, 1e-3);
  const Eigen::Matrix2d level = C.topLeftCorner<2, 2>();
  EXPECT_LT(level.norm(), 1e-3);
  const Matrix6d skew = turned.covariance - turned.covariance.transpose();
  EXPECT_LT(skew.norm(), 1e-9);
}

TEST(AlongVerticalTest, KnowsRidesFromOtherMeasurements) {
  RelativePose z;
  z.covariance = 1e-4 * Matrix6d::Identity();
  EXPECT_FALSE(leavesHeightOpen(z));
  z.covariance.diagonal().head<3>().setConstant(100);
  EXPECT_FALSE(leavesHeightOpen(z)) << "a long silence leaves everything open";
  z.covariance(0, 0) = z.covariance(1, 1) = 0.01;
  EXPECT_TRUE(leavesHeightOpen(z));
  z.kind = RelativePoseKind::kLoop;
  EXPECT_FALSE(leavesHeightOpen(z));
}

}  // namespace
}  // namespace sgraphs
