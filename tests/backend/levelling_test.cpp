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

}  // namespace
}  // namespace sgraphs
