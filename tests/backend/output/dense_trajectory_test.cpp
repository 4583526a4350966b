#include "backend/output/dense_trajectory.h"

#include <gtest/gtest.h>

namespace sgraphs {
namespace {

SE3 pose(double x, double y, double yaw) {
  return {Eigen::Quaterniond(Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ())), {x, y, 0.2}};
}

OdometryEstimate scanAt(int64_t us, const SE3& T_odom_body) {
  OdometryEstimate scan;
  scan.time = {us};
  scan.T_odom_body = T_odom_body;
  return scan;
}

void expectSame(const SE3& a, const SE3& b) {
  EXPECT_LT((a.translation - b.translation).norm(), 1e-12);
  EXPECT_LT(a.rotation.angularDistance(b.rotation), 1e-7);
}

SituationalGraph twoKeyframes(const SE3& T_map_odom_0, const SE3& T_map_odom_1) {
  SituationalGraph graph;
  const SE3 odom_0 = pose(1, 0, 0.1), odom_1 = pose(2, 1, 0.4);
  graph.keyframes[{0}] = {{0}, {1'000'000}, T_map_odom_0 * odom_0, odom_0, {}, nullptr};
  graph.keyframes[{1}] = {{1}, {2'000'000}, T_map_odom_1 * odom_1, odom_1, {}, nullptr};
  return graph;
}

TEST(DenseTrajectoryTest, KeyframesAreTheOptimisedOnes) {
  const auto graph = twoKeyframes(pose(5, -3, 1.2), pose(5.5, -3.1, 1.3));
  const std::vector<OdometryEstimate> scans = {scanAt(1'000'000, pose(1, 0, 0.1)),
                                               scanAt(2'000'000, pose(2, 1, 0.4))};
  const auto dense = denseTrajectory(graph, scans);
  expectSame(dense[0].pose, graph.keyframes.at({0}).T_map_body);
  expectSame(dense[1].pose, graph.keyframes.at({1}).T_map_body);
}

TEST(DenseTrajectoryTest, CorrectionIsBlendedLinearlyInTime) {
  const SE3 first = pose(0, 0, 0), second(Eigen::Quaterniond::Identity(), {0.4, 0, 0.2});
  const auto graph = twoKeyframes(first, second);
  const SE3 T_odom_body = pose(1.3, 0.2, 0.2);
  const auto dense = denseTrajectory(graph, std::vector{scanAt(1'250'000, T_odom_body)});
  expectSame(dense[0].pose, SE3(Eigen::Quaterniond::Identity(), {0.1, 0, 0.2}) * T_odom_body);
}

TEST(DenseTrajectoryTest, NearestCorrectionHoldsOutsideTheKeyframes) {
  const SE3 first = pose(5, -3, 1.2), second = pose(5.5, -3.1, 1.3);
  const auto graph = twoKeyframes(first, second);
  const SE3 T_odom_body = pose(1.3, 0.2, 0.2);
  const auto dense =
      denseTrajectory(graph, std::vector{scanAt(500'000, T_odom_body), scanAt(3'000'000, T_odom_body)});
  expectSame(dense[0].pose, first * T_odom_body);
  expectSame(dense[1].pose, second * T_odom_body);
}

TEST(DenseTrajectoryTest, WithoutKeyframesMapIsOdom) {
  const SE3 T_odom_body = pose(1.3, 0.2, 0.2);
  const auto dense = denseTrajectory({}, std::vector{scanAt(500'000, T_odom_body)});
  expectSame(dense[0].pose, T_odom_body);
}

}  // namespace
}  // namespace sgraphs
