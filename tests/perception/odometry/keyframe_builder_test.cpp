#include "perception/odometry/keyframe_builder.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "tests/perception/odometry/simulated_walk.h"

namespace sgraphs {
namespace {

using namespace testing_support;

LidarScan scanOf(const std::vector<Eigen::Vector3d>& points_lidar) {
  LidarScan scan;
  scan.begin = Time{0};
  scan.end = Time{100'000};
  for (const Eigen::Vector3d& p : points_lidar) {
    LidarPoint point;
    point.position_lidar = p.cast<float>();
    scan.points.push_back(point);
  }
  return scan;
}

ScanMotion stillAt(const SE3& T_odom_body) {
  return {Time{0}, Time{100'000}, {T_odom_body, T_odom_body}};
}

// A builder fed with scans of given points in odom, each seen from a pose.
struct Feed {
  KeyframeBuilder builder{KeyframeConfig(), kMount};

  void add(const std::vector<Eigen::Vector3d>& points_odom, const SE3& T_odom_body) {
    std::vector<Eigen::Vector3d> points_lidar;
    points_lidar.reserve(points_odom.size());
    for (const Eigen::Vector3d& p : points_odom) points_lidar.push_back((T_odom_body * kMount).inverse() * p);
    const LidarScan scan = scanOf(points_lidar);
    builder.add(scan, allOf(scan), {}, stillAt(T_odom_body));
  }
  Keyframe build(const SE3& T_odom_body) {
    std::vector<Surfel> surfels;
    return builder.build(T_odom_body, surfels);
  }
};

TEST(KeyframeBuilderTest, PointIsTheCentroidOfItsVoxelsReturns) {
  const SE3 T(so3Exp({0, 0, 0.7}), {10, -20, 0.5});
  const std::vector<Eigen::Vector3d> returns{
      {12.011, -19.002, 1.012}, {12.039, -19.031, 1.044}, {12.024, -19.017, 1.003}, {14.001, -19.002, 1.012}};
  Feed feed;
  feed.add(returns, T);
  const Keyframe keyframe = feed.build(T);
  ASSERT_EQ(keyframe.points.size(), 2u);
  const Eigen::Vector3d mean = (returns[0] + returns[1] + returns[2]) / 3.0;
  EXPECT_LT((T * keyframe.points[0].position_body.cast<double>() - mean).norm(), 1e-5);
  EXPECT_EQ(keyframe.points[0].count, 3);
  EXPECT_LT((T * keyframe.points[1].position_body.cast<double>() - returns[3]).norm(), 1e-5);
  EXPECT_EQ(keyframe.points[1].count, 1);
}

TEST(KeyframeBuilderTest, CountsStopAt255) {
  Feed feed;
  feed.add(std::vector<Eigen::Vector3d>(300, {2.02, 1.01, 0.52}), SE3());
  const Keyframe keyframe = feed.build(SE3());
  ASSERT_EQ(keyframe.points.size(), 1u);
  EXPECT_EQ(keyframe.points[0].count, 255);
  EXPECT_LT((keyframe.points[0].position_body - Eigen::Vector3f(2.02f, 1.01f, 0.52f)).norm(), 1e-4);
}

TEST(KeyframeBuilderTest, FacesOfAThinWallStayApart) {
  // 2 cm of wall, both faces in one voxel of 5 cm; the robot walks round it.
  Feed feed;
  feed.add({{2.01, 0.02, 0.5}}, SE3());
  feed.add({{2.03, 0.02, 0.5}}, SE3(so3Exp({0, 0, M_PI}), {4, 0, 0}));
  const Keyframe keyframe = feed.build(SE3());
  ASSERT_EQ(keyframe.points.size(), 2u);
  EXPECT_NEAR(keyframe.points[0].position_body.x(), 2.01, 1e-5);
  EXPECT_NEAR(keyframe.points[1].position_body.x(), 2.03, 1e-5);
  EXPECT_EQ(keyframe.points[0].scan, 0);
  EXPECT_EQ(keyframe.points[1].scan, 1);
}

TEST(KeyframeBuilderTest, PointsKeepTheViewpointOfTheirScan) {
  Feed feed;
  std::vector<SE3> poses;
  for (int i = 0; i < 8; ++i) {
    poses.push_back(SE3(so3Exp({0, 0.02 * i, 0.1 * i}), {0.1 * i, 0.05 * i, 0}));
    feed.add({{3.0 + 0.5 * i, 1.02, 0.52}}, poses.back());
  }
  const Keyframe keyframe = feed.build(poses.back());
  ASSERT_EQ(keyframe.points.size(), 8u);
  for (size_t i = 0; i < 8; ++i) {
    const KeyframePoint& p = keyframe.points[i];
    const SE3 T = keyframe.T_odom_body * keyframe.T_keyframe_body[p.scan] * keyframe.T_body_lidar;
    EXPECT_LT(distance(T, poses[i] * kMount), 1e-9);
  }
}

TEST(KeyframeBuilderTest, NextKeyframeBeginsEmpty) {
  Feed feed;
  feed.add({{2, 1, 0.5}}, SE3());
  feed.build(SE3());
  feed.add({{4, 1, 0.5}}, SE3());
  const Keyframe second = feed.build(SE3());
  EXPECT_EQ(second.points.size(), 1u);
  EXPECT_EQ(second.T_keyframe_body.size(), 1u);
  EXPECT_EQ(second.points[0].scan, 0);
}

TEST(KeyframeBuilderTest, StandingStillStaysBounded) {
  Feed feed;
  for (int i = 0; i < 400; ++i) feed.add({{2.02, 1.02, 0.52}, {2.02, 1.02 + 0.05 * i, 0.5}}, SE3());
  const Keyframe keyframe = feed.build(SE3());
  EXPECT_LE(keyframe.T_keyframe_body.size(), 50u);
  EXPECT_LE(keyframe.points.size(), 50u);
  for (const KeyframePoint& p : keyframe.points) EXPECT_LT(p.scan, keyframe.T_keyframe_body.size());
}

TEST(KeyframeBuilderTest, LastPoseIsTheKeyframesOwnHoweverSlowTheRobot) {
  // 400 scans standing, then creeping to the next keyframe at 1 cm per scan.
  Feed feed;
  for (int i = 0; i < 400; ++i) feed.add({{2.02, 1.02, 0.52}}, SE3());
  SE3 T;
  for (int i = 1; i <= 83; ++i) {
    T.translation.x() = 0.01 * i;
    feed.add({{2.02 + 0.05 * i, 1.02, 0.52}}, T);
  }
  const Keyframe keyframe = feed.build(T);
  EXPECT_LT(keyframe.T_keyframe_body.size(), 255u);
  EXPECT_LT(distance(keyframe.T_keyframe_body.back(), SE3()), 1e-12);
  for (const KeyframePoint& p : keyframe.points) EXPECT_LT(p.scan, keyframe.T_keyframe_body.size());
}

TEST(KeyframeBuilderTest, IsDueAfterDistanceOrRotation) {
  Feed feed;
  EXPECT_TRUE(feed.builder.due(SE3())) << "the first";
  feed.add({{2, 1, 0.5}}, SE3());
  feed.build(SE3(so3Exp({0, 0, 0.3}), {5, 5, 0}));
  EXPECT_FALSE(feed.builder.due(SE3(so3Exp({0, 0, 0.3}), {5.69, 5.69, 0})));
  EXPECT_TRUE(feed.builder.due(SE3(so3Exp({0, 0, 0.3}), {5.72, 5.72, 0})));
  EXPECT_FALSE(feed.builder.due(SE3(so3Exp({0, 0, 0.89}), {5, 5, 0})));
  EXPECT_TRUE(feed.builder.due(SE3(so3Exp({0, 0, 0.91}), {5, 5, 0})));
  EXPECT_TRUE(feed.builder.due(SE3(so3Exp({0, 0, -0.31}), {5, 5, 0})));
}

TEST(KeyframeBuilderTest, SurfelsOfItsScansComeInTheKeyframesBody) {
  Feed feed;
  Surfel s;
  s.mean = {1, 2, 0.3};
  s.normal = Eigen::Vector3d(-1, -2, 0).normalized();
  s.covariance = Eigen::Vector3d(1, 2, 3).asDiagonal();
  const SE3 T_scan = poseOf({1, 0, 0}, 0, 0, 30), T_keyframe = poseOf({1.5, 0.2, 0}, 0, 0, 50);
  const LidarScan scan = scanOf({{2, 1, 0.5}});
  feed.builder.add(scan, allOf(scan), {s, s, s, s}, stillAt(T_scan));
  std::vector<Surfel> surfels;
  feed.builder.build(T_keyframe, surfels);
  ASSERT_FALSE(surfels.empty());
  const SE3 T = T_keyframe.inverse() * T_scan;
  EXPECT_LT((surfels[0].mean - T * s.mean).norm(), 1e-9);
  EXPECT_LT((surfels[0].normal - T.rotation * s.normal).norm(), 1e-9);
  EXPECT_LT((surfels[0].covariance - T.matrix3() * s.covariance * T.matrix3().transpose()).norm(), 1e-9);
}

TEST(KeyframeBuilderTest, CloudLiesOnTheBuildingWhereThePosesAreTrue) {
  const simulate::SimulatedWorld world(simulate::makeBoxRoom(6, 5, 2.8));
  Vector6d twist;
  twist << 0.8, 0, 0, 0, 0.1, 0.8;
  const auto truth = simulate::Trajectory::constantTwist(world.scene.start, Duration::fromSeconds(1.0),
                                                         poseOf({2, 2, 0.52}, 0, 0, 20), twist);
  const simulate::SensorSimulator sensor(world.caster, truth, kMount, simulate::SensorModel(), 4);
  KeyframeBuilder builder(KeyframeConfig(), kMount);
  SE3 T_odom_body;
  for (int64_t i = 0; i < 8; ++i) {
    const LidarScan scan = sensor.scan(i);
    const ScanMotion motion{scan.begin, scan.end, {truth.poseAt(scan.begin), truth.poseAt(scan.end)}};
    builder.add(scan, prefilter(scan, kMount, PrefilterConfig()), {}, motion);
    T_odom_body = motion.T_odom_body.back();
  }
  std::vector<Surfel> surfels;
  const Keyframe keyframe = builder.build(T_odom_body, surfels);
  ASSERT_GT(keyframe.points.size(), 10000u);
  double squares = 0;
  int n = 0;
  for (size_t i = 0; i < keyframe.points.size(); i += 7, ++n) {
    const Eigen::Vector3d p = T_odom_body * keyframe.points[i].position_body.cast<double>();
    const double d = world.caster.distanceToSurface(p);
    squares += d * d;
  }
  EXPECT_LT(std::sqrt(squares / n), 0.015) << "centroids are closer than the sensor's noise";
}

}  // namespace
}  // namespace sgraphs
