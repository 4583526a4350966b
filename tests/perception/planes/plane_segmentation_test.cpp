#include "perception/planes/plane_segmentation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>

#include "common/geometry/tangent_basis.h"
#include "lcmtypes/convert/convert.h"
#include "tests/perception/planes/keyframe_clouds.h"
#include "tests/perception/planes/plane_truth.h"

namespace sgraphs {
namespace {

using namespace testing_support;

constexpr double kDegree = std::numbers::pi / 180.0;

std::vector<PlaneObservation> planesOf(const Keyframe& keyframe) {
  return PlaneSegmentation().step(keyframe).planes;
}

// Planes that face within 3 degrees of a direction and lie within 5 cm of a place along it.
std::vector<PlaneObservation> facing(const std::vector<PlaneObservation>& planes, const Eigen::Vector3d& n,
                                     double d, double within_m = 0.05) {
  std::vector<PlaneObservation> found;
  for (const PlaneObservation& plane : planes)
    if (plane.normal_body.dot(n) > std::cos(3 * kDegree) && std::abs(plane.d() - d) < within_m)
      found.push_back(plane);
  return found;
}

double angleBetween(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

std::vector<uint8_t> bytesOf(const KeyframePlanes& planes) {
  const keyframe_planes_t m = toMessage(planes);
  std::vector<uint8_t> bytes(static_cast<size_t>(m.getEncodedSize()));
  m.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  return bytes;
}

TEST(PlaneSegmentationTest, ARectangleIsExactlyThatRectangle) {
  CloudMaker cloud;
  cloud.addRectangle({3, -2, -0.5}, {0, 4, 0}, {0, 0, 2});
  const auto planes = planesOf(cloud.keyframe);
  ASSERT_EQ(planes.size(), 1u);
  const PlaneObservation& plane = planes[0];
  EXPECT_LT(angleBetween(plane.normal_body, {-1, 0, 0}), 1e-6);
  EXPECT_NEAR(plane.d(), 3.0, 1e-6);
  EXPECT_NEAR(plane.area_m2, 8.0, 0.01);
  EXPECT_NEAR(plane.num_points, 81 * 41 * 4, 20) << "all but the outermost";
  EXPECT_LT(plane.rms_m, 1e-6);
  ASSERT_EQ(plane.boundary.size(), 4u);
  const TangentBasis uv = tangentBasis(plane.normal_body);
  double twice_area = 0;
  for (size_t i = 0; i < 4; ++i) {
    const Eigen::Vector2d a = plane.boundary[i].cast<double>(),
                          b = plane.boundary[(i + 1) % 4].cast<double>();
    twice_area += a.x() * b.y() - a.y() * b.x();
    const Eigen::Vector3d corner = plane.centroid_body + uv * a;
    EXPECT_NEAR(std::abs(corner.y()), 2.0, 0.01);
    EXPECT_NEAR(std::abs(corner.z() - 0.5), 1.0, 0.01);
  }
  EXPECT_NEAR(twice_area, 16.0, 0.1) << "counter-clockwise seen from the observer";
}

TEST(PlaneSegmentationTest, WallsOneDegreeOffSquareKeepTheirAngle) {
  // A trapezoid: the wall at y = 5 is turned by 1 degree, the one at x = 7 by 12 degrees.
  simulate::Scene scene = simulate::makeBoxRoom(9.0, 7.0, 2.7);
  scene.walls = {{{0, 0}, {8, 0}, 0.1, 0, 2.7},
                 {{0, 5}, {8, 5 + 8 * std::tan(1 * kDegree)}, 0.1, 0, 2.7},
                 {{0, 0}, {0, 5}, 0.1, 0, 2.7},
                 {{7, 0}, {7 - 5.5 * std::tan(12 * kDegree), 5.5}, 0.1, 0, 2.7}};
  const simulate::SimulatedWorld world(scene);
  const Keyframe keyframe = keyframeAt(world, walkBetween({2.0, 2.0, 0.52}, {3.0, 2.2, 0.52}), {});
  const SE3 T = keyframe.T_odom_body;
  const auto planes = planesOf(keyframe);
  Eigen::Vector3d front, left, right;
  int walls = 0;
  for (const PlaneObservation& plane : planes) {
    const auto error = errorOf(plane, T, world.mesh);
    ASSERT_TRUE(error);
    EXPECT_LT(std::abs(error->error(2)), 0.003);
    if (plane.area_m2 < 4 || std::abs(error->normal_building.z()) > 0.5) continue;
    ++walls;
    EXPECT_LT(error->error.head<2>().norm(), 0.003);
    const Eigen::Vector3d n = T.rotation * plane.normal_body;
    if (n.y() < -0.9) left = n;
    if (n.y() > 0.9) right = n;
    if (n.x() < -0.9) front = n;
  }
  EXPECT_EQ(walls, 4);
  EXPECT_NEAR(angleBetween(left, -right), 1 * kDegree, 0.003);
  EXPECT_NEAR(angleBetween(front, right), 90 * kDegree + 12 * kDegree, 0.003);
}

TEST(PlaneSegmentationTest, AThinWallSeenFromBothSidesIsTwoFaces) {
  // Through the doorway of a wall of 5 cm: its faces lie at x = 3.975 and 4.025.
  simulate::Scene scene = simulate::makeBoxRoom(8.0, 6.0, 2.7);
  scene.walls.push_back({{4, 0}, {4, 6}, 0.05, 0, 2.7});
  scene.doorways.push_back({0, {4, 3, 0}, 1.2, 2.1});
  const simulate::SimulatedWorld world(scene);
  simulate::SensorModel model;
  const Keyframe keyframe = keyframeAt(world, walkBetween({3.2, 2.8, 0.52}, {4.8, 3.1, 0.52}), model);
  const Eigen::Vector3d at = keyframe.T_odom_body.translation;
  double area_m2[2] = {0, 0};
  for (const PlaneObservation& plane : planesOf(keyframe)) {
    const Eigen::Vector3d n = keyframe.T_odom_body.rotation * plane.normal_body;
    const double x = (keyframe.T_odom_body * plane.centroid_body).x();
    if (std::abs(n.x()) < 0.99 || std::abs(x - 4) > 0.2) continue;
    area_m2[n.x() > 0] += plane.area_m2;
    EXPECT_NEAR(x, n.x() > 0 ? 4.025 : 3.975, 0.006) << "seen from x = " << at.x();
    EXPECT_LT(std::abs(x - (n.x() > 0 ? 4.025 : 3.975)), 3.5 * std::sqrt(plane.covariance(2, 2)));
  }
  EXPECT_GT(area_m2[0], 4.0);
  EXPECT_GT(area_m2[1], 4.0);
}

TEST(PlaneSegmentationTest, ParallelWallsThirtyCentimetresApartStayTwo) {
  CloudMaker cloud;
  cloud.addRectangle({3, -2, -0.5}, {0, 2.2, 0}, {0, 0, 2}, 0.015);
  cloud.addRectangle({3.3, 0.2, -0.5}, {0, 2, 0}, {0, 0, 2}, 0.015);
  const auto planes = planesOf(cloud.keyframe);
  ASSERT_EQ(planes.size(), 2u);
  EXPECT_NEAR(planes[0].d(), 3.0, 0.002);
  EXPECT_NEAR(planes[1].d(), 3.3, 0.002);
  EXPECT_LT(angleBetween(planes[0].normal_body, planes[1].normal_body), 0.004);
}

// Panes, jambs and far points at grazing incidence made ghosts of a wall: second walls 3 to 9 cm behind its
// face.
TEST(PlaneSegmentationTest, JustBehindAWallThereIsNoOtherButBeforeItThereIs) {
  const auto wallWith = [](double filling_x_m) {
    CloudMaker cloud;
    const double half = 0.6, low = 0.3, high = 1.3;
    cloud.addRectangle({3, -3, -0.5}, {0, 3 - half, 0}, {0, 0, 2.4}, 0.005);
    cloud.addRectangle({3, half, -0.5}, {0, 3 - half, 0}, {0, 0, 2.4}, 0.005);
    cloud.addRectangle({3, -half, -0.5}, {0, 2 * half, 0}, {0, 0, low + 0.5}, 0.005);
    cloud.addRectangle({3, -half, high}, {0, 2 * half, 0}, {0, 0, 1.9 - high}, 0.005);
    cloud.addRectangle({filling_x_m, -half, low}, {0, 2 * half, 0}, {0, 0, high - low}, 0.005);
    return planesOf(cloud.keyframe);
  };
  const auto behind = wallWith(3.09), before = wallWith(2.91);
  ASSERT_EQ(behind.size(), 1u);
  EXPECT_NEAR(behind[0].d(), 3.0, 0.002);
  ASSERT_EQ(before.size(), 2u);
  EXPECT_NEAR(before[1].d(), 2.91, 0.003);
}

TEST(PlaneSegmentationTest, APersonLeaningOnAWallHardlyMovesIt) {
  CloudMaker cloud;
  cloud.addRectangle({3, -2, -0.5}, {0, 4, 0}, {0, 0, 2}, 0.015);
  // Back and legs, standing off by 2 to 35 cm, hide a part of the wall.
  std::erase_if(cloud.keyframe.points, [](const KeyframePoint& p) {
    return std::abs(p.position_body.y() - 0.4f) < 0.25f && p.position_body.z() < 1.2f;
  });
  for (int side = 0; side < 12; ++side) {
    const double a0 = std::numbers::pi * side / 12, a1 = std::numbers::pi * (side + 1) / 12;
    const Eigen::Vector3d low(2.98 - 0.25 * std::sin(a0), 0.4 - 0.25 * std::cos(a0), -0.5);
    const Eigen::Vector3d edge(0.25 * (std::sin(a0) - std::sin(a1)), 0.25 * (std::cos(a0) - std::cos(a1)), 0);
    cloud.addRectangle(low + Eigen::Vector3d(-0.08, 0, 0), edge, {0.08, 0, 1.7}, 0.015);
  }
  const auto wall = facing(planesOf(cloud.keyframe), {-1, 0, 0}, 3.0);
  ASSERT_EQ(wall.size(), 1u) << "one segment, though the person's shadow is 0.5 m wide";
  EXPECT_NEAR(-wall[0].normal_body.dot(Eigen::Vector3d(3, 0, 0.5)), wall[0].d() - 0.0, 0.02);
  EXPECT_NEAR(wall[0].d(), 3.0, 0.004);
  EXPECT_LT(angleBetween(wall[0].normal_body, {-1, 0, 0}), 0.004);
}

TEST(PlaneSegmentationTest, ANoisyWallIsStillOneWall) {
  for (const double noise_m : {0.005, 0.015, 0.03}) {
    CloudMaker cloud;
    cloud.addRectangle({3, -2, -0.5}, {0, 4, 0}, {0, 0, 2}, noise_m, 0.04);
    const auto planes = planesOf(cloud.keyframe);
    ASSERT_EQ(planes.size(), 1u) << noise_m;
    EXPECT_NEAR(planes[0].d(), 3.0, 0.005);
    EXPECT_NEAR(planes[0].rms_m, noise_m, 0.25 * noise_m);
  }
}

TEST(PlaneSegmentationTest, GlassInventsNoPlane) {
  // A front of glass at x = 3 returns a spot of 20 cm where the beams hit it square; beyond it the beams hit
  // clutter at all depths.
  CloudMaker cloud;
  cloud.addRectangle({3, -0.1, 0}, {0, 0.2, 0}, {0, 0, 0.2}, 0.01);
  std::uniform_real_distribution<double> depth(3.0, 9.0);
  for (int i = 0; i < 3000; ++i) {
    const int column = i % 100, row = i / 100;
    const double azimuth = -0.6 + 1.2 * column / 100.0, elevation = -0.25 + 0.5 * row / 30.0;
    const Eigen::Vector3d ray(std::cos(azimuth) * std::cos(elevation),
                              std::sin(azimuth) * std::cos(elevation), std::sin(elevation));
    cloud.keyframe.points.push_back({(depth(cloud.random) * ray).cast<float>(), 0, 1});
  }
  EXPECT_TRUE(planesOf(cloud.keyframe).empty());
}

TEST(PlaneSegmentationTest, ADoorwayJoinsByItsLintelAndSplitsWithoutIt) {
  const auto wallWithGap = [](double gap_m, bool lintel) {
    CloudMaker cloud;
    cloud.addRectangle({3, -2.5, -0.5}, {0, 2.5 - gap_m / 2, 0}, {0, 0, 2.7}, 0.01);
    cloud.addRectangle({3, gap_m / 2, -0.5}, {0, 2.5 - gap_m / 2, 0}, {0, 0, 2.7}, 0.01);
    if (lintel) cloud.addRectangle({3, -gap_m / 2, 1.6}, {0, gap_m, 0}, {0, 0, 0.6}, 0.01);
    return planesOf(cloud.keyframe);
  };
  EXPECT_EQ(wallWithGap(0.9, false).size(), 2u);
  EXPECT_EQ(wallWithGap(0.4, false).size(), 1u) << "the shadow of a cupboard";
  const auto joined = wallWithGap(0.9, true);
  ASSERT_EQ(joined.size(), 1u);
  EXPECT_NEAR(joined[0].area_m2, 5.0 * 2.7 - 0.9 * 2.1, 0.35) << "the doorway is a notch of the outline";
}

TEST(PlaneSegmentationTest, ARoomIsItsFacesAndNothingElse) {
  const simulate::SimulatedWorld world(furnishedRoom());
  const Keyframe keyframe = keyframeAt(world, walkBetween({2.5, 2.0, 0.52}, {3.5, 2.2, 0.52}, 20), {});
  const KeyframePlanes planes = PlaneSegmentation().step(keyframe);
  EXPECT_EQ(planes.keyframe, keyframe.id);
  EXPECT_EQ(planes.time, keyframe.time);
  int large = 0;
  double before_m2 = 1e9;
  for (const PlaneObservation& plane : planes.planes) {
    EXPECT_LE(plane.area_m2, before_m2) << "largest first";
    before_m2 = plane.area_m2;
    const auto error = errorOf(plane, keyframe.T_odom_body, world.mesh);
    EXPECT_TRUE(error) << plane.centroid_body.transpose();
    EXPECT_GT(plane.d(), 0);
    EXPECT_LE(plane.boundary.size(), 48u);
    large += plane.area_m2 > 3;
  }
  EXPECT_GE(large, 5) << "four walls and the floor";
}

TEST(PlaneSegmentationTest, TheSameCloudGivesTheSameBytes) {
  const simulate::SimulatedWorld world(furnishedRoom());
  const Keyframe keyframe = keyframeAt(world, walkBetween({2.5, 2.0, 0.52}, {3.2, 2.2, 0.52}), {});
  const PlaneSegmentation one, two;
  const auto first = bytesOf(one.step(keyframe));
  EXPECT_GT(first.size(), 1000u);
  two.step(keyframeAt(world, walkBetween({1.5, 1.0, 0.52}, {1.7, 1.2, 0.52}), {}));
  EXPECT_EQ(bytesOf(two.step(keyframe)), first);
}

TEST(PlaneSegmentationTest, LittleOrNothingIsNoPlane) {
  Keyframe empty;
  EXPECT_TRUE(planesOf(empty).empty());
  empty.T_keyframe_body = {SE3()};
  EXPECT_TRUE(planesOf(empty).empty());
  Keyframe one = empty;
  one.points.push_back({{2, 0, 0}, 0, 255});
  EXPECT_TRUE(planesOf(one).empty());
  one.points.assign(5000, {{2, 0, 0}, 0, 255});
  EXPECT_TRUE(planesOf(one).empty()) << "many times the same point";
  one.points.clear();
  for (int i = 0; i < 2000; ++i) one.points.push_back({{2, 0.01f * static_cast<float>(i), 0}, 0, 255});
  EXPECT_TRUE(planesOf(one).empty()) << "a line";
}

TEST(PlaneSegmentationTest, PlacesThatNoLidarSeesAreLeftOut) {
  CloudMaker cloud;
  cloud.addRectangle({3, -2, -0.5}, {0, 4, 0}, {0, 0, 2});
  Keyframe& keyframe = cloud.keyframe;
  keyframe.points.push_back({{1e30f, -1e30f, 1e30f}, 0, 1});
  keyframe.points.push_back({{0, 0, 0}, 0, 1});
  keyframe.points.push_back({{3, 0, 0}, 77, 1});  // of a scan that is not there
  EXPECT_EQ(planesOf(keyframe).size(), 1u);
}

TEST(PlaneSegmentationTest, CovarianceGrowsWithTheNoise) {
  PlanesConfig config;
  config.noise.offset_floor_m = config.noise.height_floor_m = config.noise.tilt_floor_rad = 0;
  const PlaneSegmentation segmentation(config);
  Eigen::Vector3d quiet, loud;
  for (const double noise_m : {0.006, 0.012}) {
    CloudMaker cloud;
    cloud.addRectangle({3, -1, -0.5}, {0, 2, 0}, {0, 0, 1.5}, noise_m);
    const auto planes = segmentation.step(cloud.keyframe).planes;
    ASSERT_EQ(planes.size(), 1u);
    (noise_m < 0.01 ? quiet : loud) = planes[0].covariance.diagonal();
  }
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(loud(i) / quiet(i), 4.0, 0.8);
}

TEST(PlaneSegmentationTest, CovarianceWithoutFloorsIsTheErrorOfIndependentPoints) {
  PlanesConfig config;
  config.noise.offset_floor_m = config.noise.height_floor_m = config.noise.tilt_floor_rad = 0;
  config.noise.scale = 1;
  const PlaneSegmentation segmentation(config);
  double nees = 0;
  constexpr int kClouds = 60;
  for (uint64_t seed = 1; seed <= kClouds; ++seed) {
    CloudMaker cloud(seed);
    cloud.addRectangle({3, -0.5, -0.5}, {0, 1, 0}, {0, 0, 1}, 0.01);
    const auto planes = segmentation.step(cloud.keyframe).planes;
    ASSERT_EQ(planes.size(), 1u);
    const PlaneObservation& plane = planes[0];
    const TangentBasis uv = tangentBasis(plane.normal_body);
    const Eigen::Vector3d n(-1, 0, 0);
    Eigen::Vector3d error;
    error << uv.transpose() * n, (3.0 - plane.centroid_body.x()) * n.x() / n.dot(plane.normal_body);
    nees += error.dot(plane.covariance.inverse() * error);
  }
  // Chi-square of 180 degrees of freedom over 60: 3 +- 0.32.
  EXPECT_GT(nees / kClouds, 2.0);
  EXPECT_LT(nees / kClouds, 4.2);
}

}  // namespace
}  // namespace sgraphs
