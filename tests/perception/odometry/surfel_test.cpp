#include "perception/odometry/surfel.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>
#include <random>

#include "perception/odometry/scan_image.h"
#include "tests/perception/odometry/simulated_walk.h"

namespace sgraphs {
namespace {

using namespace testing_support;
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

LidarScan unorganised(const std::vector<Eigen::Vector3f>& points) {
  LidarScan scan;
  for (const Eigen::Vector3f& p : points) {
    LidarPoint point;
    point.position_lidar = p;
    scan.points.push_back(point);
  }
  return scan;
}

// Returns of a wall at x = 4 m on three rings, 0.2 degrees apart.
LidarScan wallAhead() {
  LidarScan scan;
  scan.num_rings = 16;
  for (uint16_t column = 800; column < 840; ++column)
    for (uint8_t ring = 6; ring < 9; ++ring) {
      LidarPoint p;
      const double azimuth = 0.0035 * (820 - column);
      p.position_lidar = Eigen::Vector3d(4, 4 * std::tan(azimuth), 0.14 * (ring - 7)).cast<float>();
      p.column = column;
      p.ring = ring;
      scan.points.push_back(p);
    }
  return scan;
}

simulate::SimulatedWorld boxRoom() {
  return simulate::SimulatedWorld(simulate::makeBoxRoom(6, 5, 2.8));
}
const SE3 kInRoom = poseOf({2.5, 2.2, 1.0}, 1, -2, 25);

double planeDistance(const Eigen::Vector3d& p) {
  return std::min({std::abs(p.x()), std::abs(p.x() - 6), std::abs(p.y()), std::abs(p.y() - 5),
                   std::abs(p.z()), std::abs(p.z() - 2.8)});
}

TEST(PrefilterTest, KeepsOnlyRangesWithinTheGate) {
  PrefilterConfig config;
  config.min_range_m = 1.0;
  config.max_range_m = 20.0;
  const LidarScan scan =
      unorganised({{0.9f, 0, 1}, {0.99f, 0, 0}, {1.01f, 0, 0}, {19.9f, 0, 0}, {20.1f, 0, 0}});
  EXPECT_EQ(prefilter(scan, SE3(SE3().rotation, {0, 0, 5}), config), (std::vector<int32_t>{0, 2, 3}));
}

TEST(PrefilterTest, TakesTheRobotsOwnBoxInItsBodyFrame) {
  // The sensor looks to the robot's left: its x axis is the body's y axis.
  const SE3 T_body_lidar = poseOf({0.12, 0, 0.31}, 0, 0, 90);
  const Eigen::Vector3d own(-0.5, 0.2, -0.2), beside(-0.2, 0.5, -0.2), above(-0.5, 0.2, 0.4);
  std::vector<Eigen::Vector3f> points;
  for (const Eigen::Vector3d& p : {own, beside, above})
    points.push_back((T_body_lidar.inverse() * p).cast<float>());
  EXPECT_EQ(prefilter(unorganised(points), T_body_lidar, PrefilterConfig()), (std::vector<int32_t>{1, 2}));
}

TEST(PrefilterTest, DropsWhatIsNotFinite) {
  const float inf = std::numeric_limits<float>::infinity();
  const LidarScan scan =
      unorganised({{kNan, 0, 3}, {3, kNan, 0}, {0, 3, inf}, {3, 0, 0}, {kNan, kNan, kNan}});
  EXPECT_EQ(prefilter(scan, SE3(), PrefilterConfig()), (std::vector<int32_t>{3}));
}

TEST(PrefilterTest, DropsAReturnAloneInTheAir) {
  LidarScan scan = wallAhead();
  const size_t wall = scan.points.size();
  LidarPoint lone = scan.points[wall / 2];
  lone.position_lidar *= 0.5f;  // an insect on the way to the wall
  lone.ring = 9;
  scan.points.push_back(lone);
  const std::vector<int32_t> kept = prefilter(scan, SE3(), PrefilterConfig());
  EXPECT_EQ(kept.size(), wall);
  EXPECT_EQ(std::count(kept.begin(), kept.end(), static_cast<int32_t>(wall)), 0);
}

TEST(PrefilterTest, DropsReturnsOfARingThatTheScanDoesNotHave) {
  LidarScan scan = wallAhead();
  const size_t wall = scan.points.size();
  scan.points.push_back(scan.points.back());
  scan.points.back().ring = 200;
  EXPECT_EQ(prefilter(scan, SE3(), PrefilterConfig()).size(), wall);
}

TEST(ScanImageTest, FirstColumnFollowsTheLast) {
  LidarScan scan = wallAhead();
  scan.points[0].column = 0;
  const ScanImage image(scan, allOf(scan));
  EXPECT_EQ(image.columns(), 840);
  EXPECT_EQ(image.at(6, 840), 0);
  EXPECT_EQ(image.at(8, -1), static_cast<int32_t>(scan.points.size()) - 1);
  EXPECT_EQ(image.at(3, 820), -1);
}

TEST(ScanImageTest, ScanWithoutColumnsGetsThemFromAzimuthClockwise) {
  LidarScan scan = wallAhead();
  for (LidarPoint& p : scan.points) p.column = 0;
  const ScanImage image(scan, allOf(scan));
  LidarPoint left, right, behind;
  left.position_lidar = {0, 5, 0};
  right.position_lidar = {0, -5, 0};
  behind.position_lidar = {-5, -1e-4f, 0};
  EXPECT_GT(image.columnOf(right), image.columnOf(left));
  EXPECT_NEAR(image.columnOf(right) - image.columnOf(left), 0.5 * image.columns(), 1);
  EXPECT_LT(image.columnOf(behind), image.columns());
  // Neighbours of one ring stand in neighbouring columns.
  for (size_t i = 0; i + 3 < scan.points.size(); i += 3)
    EXPECT_NEAR(image.columnOf(scan.points[i + 3]) - image.columnOf(scan.points[i]), 1, 1);
}

TEST(SurfelTest, NormalsOfABoxRoomStandOnItsFacesTowardsTheSensor) {
  const auto world = boxRoom();
  const std::vector<Surfel> surfels = surfelsOf(simulateScan(world, kInRoom));
  ASSERT_GT(surfels.size(), 1500u);
  int square = 0, on_faces = 0;
  for (const Surfel& s : surfels) {
    EXPECT_NEAR(s.normal.norm(), 1.0, 1e-9);
    EXPECT_LT(s.normal.dot(s.mean), 0);
    square += (kInRoom.rotation * s.normal).cwiseAbs().maxCoeff() > std::cos(0.01);
    // Across an edge a patch rounds it off.
    EXPECT_LT(planeDistance(kInRoom * s.mean), 0.06);
    on_faces += planeDistance(kInRoom * s.mean) < 0.005;
  }
  // The rest lies across edges of the room, within the thickness that a patch may have.
  EXPECT_GT(square, 0.93 * static_cast<double>(surfels.size()));
  EXPECT_GT(on_faces, 0.93 * static_cast<double>(surfels.size()));
}

TEST(SurfelTest, NoPatchIsThickerThanTheLimit) {
  const auto world = boxRoom();
  for (const Surfel& s : surfelsOf(simulateScan(world, kInRoom, simulate::SensorModel(), 3))) {
    const Eigen::Vector3d values = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(s.covariance).eigenvalues();
    EXPECT_LT(std::sqrt(std::max(values[0], 0.0)), SurfelConfig().max_thickness_m);
    EXPECT_GE(s.count, SurfelConfig().min_points);
  }
}

TEST(SurfelTest, ThicknessIsTheSensorsNoise) {
  const auto world = boxRoom();
  simulate::SensorModel model;
  model.range_sigma_m = 0.015;
  double squares = 0, freedom = 0;
  for (const Surfel& s : surfelsOf(simulateScan(world, kInRoom, model, 5))) {
    // Far from edges, seen within 30 degrees of its normal: noise of range is noise along the normal.
    const Eigen::Vector3d n = kInRoom.rotation * s.normal;
    if (n.cwiseAbs().maxCoeff() < 0.97 || -s.normal.dot(s.mean.normalized()) < 0.87) continue;
    squares += s.count * s.normal.dot(s.covariance * s.normal);
    freedom += s.count - 3;
  }
  ASSERT_GT(freedom, 3000);
  EXPECT_NEAR(std::sqrt(squares / freedom), 0.015, 0.002);
}

TEST(SurfelTest, TheStatedVarianceOfTheNormalIsItsError) {
  // 50 points, 15 mm thick, twice to four times as wide.
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  for (const double width_m : {0.030, 0.060}) {
    double squares = 0;
    constexpr int kPatches = 3000, kPoints = 50;
    for (int i = 0; i < kPatches; ++i) {
      Eigen::Matrix3Xd points(3, kPoints);
      for (Eigen::Index k = 0; k < kPoints; ++k)
        points.col(k) << 0.2 * normal(random), width_m * normal(random), 0.015 * normal(random);
      points.colwise() -= points.rowwise().mean().eval();
      const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(points * points.transpose());
      const Eigen::Vector3d n = eigen.eigenvectors().col(0);
      squares += std::pow(std::atan(n.y() / n.z()), 2);
    }
    const double stated = normalVariance(0.015 * 0.015, width_m * width_m, kPoints);
    EXPECT_NEAR(squares / kPatches / stated, 1.0, 0.2) << width_m;
  }
  EXPECT_GT(normalVariance(2e-4, 2e-4, 1000), 1.0) << "as thick as wide: no normal";
}

TEST(SurfelTest, TheStatedVarianceOfTheMeanIsItsError) {
  const auto world = boxRoom();
  double nees = 0;
  int n = 0;
  for (const Surfel& s : surfelsOf(simulateScan(world, kInRoom, simulate::SensorModel(), 7))) {
    if ((kInRoom.rotation * s.normal).cwiseAbs().maxCoeff() < 0.97) continue;
    const double error = planeDistance(kInRoom * s.mean);
    nees += error * error / s.variance_m2;
    ++n;
  }
  EXPECT_GT(nees / n, 0.5);
  EXPECT_LT(nees / n, 2.0);
}

TEST(SurfelTest, IsTheSameAtAnyNumberOfThreads) {
  const auto world = boxRoom();
  const LidarScan scan = simulateScan(world, kInRoom, simulate::SensorModel(), 11);
  const SE3 T_body_lidar = poseOf({0.1, 0, 0.3}, 0, 2, 90);
  const auto one = extractSurfels(scan, allOf(scan), T_body_lidar, SurfelConfig(), 1);
  for (const int threads : {2, 4}) {
    const auto many = extractSurfels(scan, allOf(scan), T_body_lidar, SurfelConfig(), threads);
    ASSERT_EQ(many.size(), one.size());
    for (size_t i = 0; i < one.size(); ++i) {
      EXPECT_EQ(many[i].mean, one[i].mean);
      EXPECT_EQ(many[i].normal, one[i].normal);
      EXPECT_EQ(many[i].covariance, one[i].covariance);
      EXPECT_EQ(many[i].time_us, one[i].time_us);
    }
  }
}

TEST(SurfelTest, LiesInBodyWhereTheLidarIsMounted) {
  const auto world = boxRoom();
  const LidarScan scan = simulateScan(world, kInRoom);
  const SE3 T_body_lidar = poseOf({0.1, -0.2, 0.3}, 3, 2, 90);
  const auto in_lidar = surfelsOf(scan);
  const auto in_body = extractSurfels(scan, allOf(scan), T_body_lidar, SurfelConfig(), 1);
  ASSERT_EQ(in_lidar.size(), in_body.size());
  const Eigen::Matrix3d R = T_body_lidar.matrix3();
  for (size_t i = 0; i < in_body.size(); ++i) {
    EXPECT_LT((in_body[i].mean - T_body_lidar * in_lidar[i].mean).norm(), 1e-9);
    EXPECT_LT((in_body[i].normal - R * in_lidar[i].normal).norm(), 1e-9);
    EXPECT_LT((in_body[i].covariance - R * in_lidar[i].covariance * R.transpose()).norm(), 1e-9);
  }
}

TEST(SurfelTest, CloudWithoutRingsGivesPatchesToo) {
  const auto world = boxRoom();
  LidarScan scan = simulateScan(world, kInRoom, simulate::SensorModel(), 13);
  scan.num_rings = 0;
  for (LidarPoint& p : scan.points) p.ring = 0, p.column = 0;
  const std::vector<Surfel> surfels = surfelsOf(scan);
  ASSERT_GT(surfels.size(), 200u);
  int square = 0;
  for (const Surfel& s : surfels) {
    EXPECT_LT(s.normal.dot(s.mean), 0);
    square += (kInRoom.rotation * s.normal).cwiseAbs().maxCoeff() > std::cos(0.15);
  }
  EXPECT_GT(square, 0.9 * static_cast<double>(surfels.size()));
}

TEST(SurfelTest, OfNothingIsNothing) {
  EXPECT_TRUE(surfelsOf(LidarScan()).empty());
  LidarScan empty;
  empty.num_rings = 16;
  EXPECT_TRUE(surfelsOf(empty).empty());
  EXPECT_TRUE(surfelsOf(unorganised({{1, 2, 3}, {2, 2, 3}})).empty());
}

}  // namespace
}  // namespace sgraphs
