#include "tools/simulate/building/building.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tools/simulate/scene/test_worlds.h"
#include "tools/simulate/sensor/random_stream.h"

namespace sgraphs::simulate {
namespace {

Scene wallWithDoorway() {
  Scene scene;
  scene.walls.push_back({{0, 0}, {4, 0}, 0.2, 0, 2.8});
  scene.doorways.push_back({0, {1.5, 0, 0}, 1.0, 2.1});
  return scene;
}

bool passes(const RayCaster& caster, const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  const Eigen::Vector3d way = to - from;
  return !caster.cast(from, way.normalized(), way.norm()).has_value();
}

// Six times the volume between the origin and the surface: positive if triangles are seen from outside.
double signedVolume(const TriangleMesh& mesh) {
  double six = 0;
  for (const auto& t : mesh.triangles)
    six += mesh.vertices[t[0]].dot(mesh.vertices[t[1]].cross(mesh.vertices[t[2]]));
  return six / 6.0;
}

TEST(BuildingTest, DoorwayIsOpenAndItsLintelAndSidesAreClosed) {
  const RayCaster caster(buildMesh(wallWithDoorway()));
  EXPECT_TRUE(passes(caster, {1.5, -2, 1}, {1.5, 2, 1}));
  EXPECT_TRUE(passes(caster, {1.01, -2, 0.01}, {1.01, 2, 0.01}));
  EXPECT_TRUE(passes(caster, {1.99, -2, 2.09}, {1.99, 2, 2.09}));
  EXPECT_FALSE(passes(caster, {1.5, -2, 2.11}, {1.5, 2, 2.11}));
  EXPECT_FALSE(passes(caster, {0.99, -2, 1}, {0.99, 2, 1}));
  EXPECT_FALSE(passes(caster, {2.01, -2, 1}, {2.01, 2, 1}));
}

TEST(BuildingTest, WallPartsFillAllButTheOpening) {
  const Scene scene = wallWithDoorway();
  double area = 0;
  for (const WallPart& part : wallParts(scene.walls[0], openingsOf(scene, scene.walls[0])))
    area += (part.end_m - part.begin_m) * (part.z_max_m - part.z_min_m);
  EXPECT_NEAR(area, 4 * 2.8 - 1.0 * 2.1, 1e-9);
}

TEST(BuildingTest, OverlappingAndRaisedOpeningsAreCutOnce) {
  Scene scene = wallWithDoorway();
  scene.doorways.push_back({0, {2.0, 0, 0.5}, 1.0, 1.0});  // a hatch beside and over the doorway
  double area = 0;
  for (const WallPart& part : wallParts(scene.walls[0], openingsOf(scene, scene.walls[0])))
    area += (part.end_m - part.begin_m) * (part.z_max_m - part.z_min_m);
  EXPECT_NEAR(area, 4 * 2.8 - 1.0 * 2.1 - 0.5 * 1.0, 1e-9);
}

TEST(BuildingTest, BoxesAreClosedAndSeenFromOutside) {
  TriangleMesh mesh;
  mesh.addBox({3, -2, 1}, {2, 0.5, 1.5}, 0.7, 50);
  EXPECT_NEAR(signedVolume(mesh), 2 * 0.5 * 1.5, 1e-9);
  EXPECT_EQ(mesh.triangles.size(), 12u);
}

TEST(BuildingTest, NothingIsSeenThroughTheCornersOfARoom) {
  const SimulatedWorld room(makeBoxRoom(5, 3, 2.5));
  const Eigen::Vector3d eye(1.7, 1.1, 0.9);
  // A fan of rays around every corner and edge of the room.
  for (const double x : {0.0, 5.0})
    for (const double y : {0.0, 3.0})
      for (const double z : {0.0, 0.4, 1.25, 2.5})
        for (double shift = -0.02; shift <= 0.02; shift += 1e-4) {
          const Eigen::Vector3d inner(x, y, z);
          const Eigen::Vector3d ray = (inner + Eigen::Vector3d(shift, -shift, 0) - eye).normalized();
          const auto hit = room.caster.cast(eye, ray, 100);
          ASSERT_TRUE(hit.has_value()) << inner.transpose() << " " << shift;
          EXPECT_LT(hit->range_m, (inner - eye).norm() + 0.03);
        }
}

TEST(BuildingTest, NothingIsSeenThroughTheJointsOfAnyWallAtAnyAngle) {
  for (double angle = 0.3; angle < 3.0; angle += 0.31) {
    Scene scene;
    const Eigen::Vector2d far(4 * std::cos(angle), 4 * std::sin(angle));
    scene.walls.push_back({{4, 0}, {0, 0}, 0.1, 0, 2.5});
    scene.walls.push_back({{0, 0}, far, 0.1, 0, 2.5});
    const RayCaster caster(buildMesh(scene));
    const Eigen::Vector2d bisector(std::cos(0.5 * angle), std::sin(0.5 * angle));
    const Eigen::Vector3d eye(bisector.x() * 2, bisector.y() * 2, 1.0);
    for (double across = -0.3; across <= 0.3; across += 1e-3) {
      const Eigen::Vector3d aim(-bisector.y() * across, bisector.x() * across, 1.3);
      EXPECT_FALSE(passes(caster, eye, aim + (aim - eye))) << angle << " " << across;
    }
  }
}

TEST(BuildingTest, RangesAreExactInABoxRoom) {
  const SimulatedWorld room(makeBoxRoom(6, 4, 2.8));
  const Eigen::Vector3d eye(2, 1, 1);
  RandomStream random(7, 0);
  for (int i = 0; i < 2000; ++i) {
    const Eigen::Vector3d ray =
        Eigen::Vector3d(random.normal(), random.normal(), random.normal()).normalized();
    // Slab method by hand.
    double expected = 1e9;
    const Eigen::Vector3d low(0, 0, 0), high(6, 4, 2.8);
    for (int k = 0; k < 3; ++k)
      expected = std::min(expected, ((ray[k] > 0 ? high : low)[k] - eye[k]) / ray[k]);
    const auto hit = room.caster.cast(eye, ray, 100);
    ASSERT_TRUE(hit.has_value());
    EXPECT_NEAR(hit->range_m, expected, 2e-5);
    EXPECT_LT(room.caster.distanceToSurface(eye + hit->range_m * ray), 2e-5);
  }
}

TEST(BuildingTest, NothingIsHitBeyondTheMaximumRange) {
  const SimulatedWorld room(makeBoxRoom(6, 4));
  EXPECT_FALSE(room.caster.cast({2, 1, 1}, {1, 0, 0}, 3.9).has_value());
  EXPECT_TRUE(room.caster.cast({2, 1, 1}, {1, 0, 0}, 4.1).has_value());
}

TEST(BuildingTest, DefaultSlabsCloseEveryStorey) {
  Scene scene = makeBoxRoom(6, 4, 2.5);
  scene.floors_z_m = {0, 3};
  const size_t ground_walls = scene.walls.size();
  for (size_t i = 0; i < ground_walls; ++i) {
    Wall upper = scene.walls[i];
    upper.z_min_m = 3;
    upper.z_max_m = 5.5;
    scene.walls.push_back(upper);
  }
  const RayCaster caster(buildMesh(scene));
  const auto height = [&](double z, double direction) {
    return caster.cast({3, 2, z}, {0, 0, direction}, 100)->range_m;
  };
  EXPECT_NEAR(height(1, -1), 1.0, 1e-5);
  EXPECT_NEAR(height(1, 1), 1.5, 1e-5);
  EXPECT_NEAR(height(4, -1), 1.0, 1e-5);
  EXPECT_NEAR(height(4, 1), 1.5, 1e-5);
}

}  // namespace
}  // namespace sgraphs::simulate
