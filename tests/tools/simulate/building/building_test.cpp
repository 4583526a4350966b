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

double range(const RayCaster& caster, const Eigen::Vector3d& from, const Eigen::Vector3d& way) {
  const auto hit = caster.cast(from, way.normalized(), 100);
  return hit ? hit->range_m : -1.0;
}

TEST(BuildingTest, DefaultCeilingIsTheNextFloorWhereWallsReachIt) {
  for (const double wall_top : {2.8, 2.9, 3.0, 6.0}) {
    Scene scene = makeBoxRoom(6, 4, wall_top);
    scene.floors_z_m = {0, 3};
    Wall upper = scene.walls[0];
    upper.z_min_m = 3;
    upper.z_max_m = 6;
    scene.walls.push_back(upper);
    const auto slabs = defaultSlabs(scene);
    // No two share a height, and none stands out of the upper floor.
    EXPECT_EQ(slabs.size(), wall_top == 2.8 ? 4u : 3u) << wall_top;
    const RayCaster caster(buildMesh(scene));
    EXPECT_NEAR(range(caster, {3, 2, 4}, {0, 0, -1}), 1.0, 1e-5) << wall_top;
    EXPECT_NEAR(range(caster, {3, 2, 4}, {0, 0, 1}), 2.0, 1e-5) << wall_top;
    EXPECT_NEAR(range(caster, {3, 2, 1}, {0, 0, 1}), std::min(wall_top, 2.9) - 1, 1e-5) << wall_top;
  }
}

TEST(BuildingTest, StairwellIsOpenAboveTheFlightOnly) {
  const RayCaster caster(buildMesh(makeTwoStoreys()));
  // From the upper storey down: the steps within the well, the floor beside, before and behind it.
  const auto depth = [&](double x, double y) { return range(caster, {x, y, 5}, {0, 0, -1}); };
  EXPECT_NEAR(depth(1.51, 1.0), 5 - 3.0 / 16, 1e-5);
  EXPECT_NEAR(depth(3.0, 0.41), 5 - 3.0 * 6 / 16, 1e-5);  // 1.5 m on: in the sixth step of 0.3 m
  EXPECT_NEAR(depth(6.29, 1.59), 2, 1e-5);
  for (const Eigen::Vector2d& xy : {Eigen::Vector2d(1.49, 1), {3, 0.39}, {3, 1.61}, {6.31, 1}})
    EXPECT_NEAR(depth(xy.x(), xy.y()), 2, 1e-5) << xy.transpose();
  // The floor under the foot and the ceiling of the upper storey are whole.
  EXPECT_NEAR(range(caster, {1.2, 1, 1}, {0, 0, -1}), 1, 1e-5);
  EXPECT_NEAR(range(caster, {3, 1, 5}, {0, 0, 1}), 0.8, 1e-5);
}

TEST(BuildingTest, StairsAreSolidStepsSeenFromOutside) {
  Scene scene;
  scene.slabs.push_back({{-9, -9}, {-8, -8}, 0, 1});
  scene.stairs.push_back({{0, 0}, {0, 3}, 2, 0.5, 2.0, 5});  // along y: treads of 0.6 m, risers of 0.3 m
  TriangleMesh mesh = buildMesh(scene);
  const RayCaster caster(mesh);
  for (int k = 0; k < 5; ++k) {
    const double top = 0.5 + 0.3 * (k + 1);
    EXPECT_NEAR(range(caster, {0.9, 0.6 * k + 0.3, 4}, {0, 0, -1}), 4 - top, 1e-5) << k;
    EXPECT_NEAR(range(caster, {-0.9, -1, top - 0.1}, {0, 1, 0}), 1 + 0.6 * k, 1e-5) << k;
    EXPECT_NEAR(range(caster, {5, 0.6 * k + 0.3, top - 0.1}, {-1, 0, 0}), 4, 1e-5) << k;
    EXPECT_NEAR(range(caster, {-5, 0.6 * k + 0.3, 0.6}, {1, 0, 0}), 4, 1e-5) << k;
  }
  EXPECT_NEAR(range(caster, {0, 5, 1.9}, {0, -1, 0}), 2, 1e-5);
  EXPECT_NEAR(range(caster, {0, 1, -1}, {0, 0, 1}), 1.5, 1e-5);
  EXPECT_FALSE(caster.cast({1.01, -1, 0.6}, {0, 1, 0}, 100).has_value());
  const double slab_volume = 1;
  EXPECT_NEAR(signedVolume(mesh), slab_volume + 0.6 * 2 * 0.3 * (1 + 2 + 3 + 4 + 5), 1e-9);
}

TEST(BuildingTest, ColumnsArePrismsOfTwentyFourSides) {
  Scene scene = makeBoxRoom(6, 4);
  const double volume = signedVolume(buildMesh(scene));
  scene.columns.push_back({"", {3, 2}, 0.4, 0, 2.8});
  const TriangleMesh mesh = buildMesh(scene);
  const double angle = 2 * std::numbers::pi / 24;
  EXPECT_NEAR(signedVolume(mesh) - volume, 12 * 0.4 * 0.4 * std::sin(angle) * 2.8, 1e-9);
  const RayCaster caster(mesh);
  // Onto a corner, and onto the middle of the side next to it.
  EXPECT_NEAR(range(caster, {5, 2, 1}, {-1, 0, 0}), 2 - 0.4, 1e-5);
  const Eigen::Vector3d out(std::cos(0.5 * angle), std::sin(0.5 * angle), 0);
  EXPECT_NEAR(range(caster, Eigen::Vector3d(3, 2, 1) + out, -out), 1 - 0.4 * std::cos(0.5 * angle), 1e-5);
  EXPECT_TRUE(passes(caster, {5, 2.401, 1}, {1, 2.401, 1}));
}

TEST(BuildingTest, WindowsAreHolesAndGlazedOnesHoldAPane) {
  Scene scene;
  scene.walls.push_back({{0, 0}, {4, 0}, 0.2, 0, 2.8});
  scene.windows.push_back({{1, 0, 0.9}, 1.0, 1.2, false});
  scene.windows.push_back({{3, 0, 0.0}, 1.0, 1.2, true});
  const RayCaster caster(buildMesh(scene), buildGlass(scene));
  const auto glass_at = [&](double x, double z) {
    const auto pane = caster.castGlass({x, -2, z}, {0, 1, 0}, 0, 100);
    return pane ? pane->range_m : -1.0;
  };
  EXPECT_TRUE(passes(caster, {1, -2, 0.91}, {1, 2, 0.91}));
  EXPECT_TRUE(passes(caster, {1, -2, 2.09}, {1, 2, 2.09}));
  EXPECT_FALSE(passes(caster, {1, -2, 0.89}, {1, 2, 0.89}));
  EXPECT_FALSE(passes(caster, {1, -2, 2.11}, {1, 2, 2.11}));
  EXPECT_FALSE(passes(caster, {0.49, -2, 1.5}, {0.49, 2, 1.5}));
  EXPECT_EQ(glass_at(1, 1.5), -1);
  // The pane fills the opening, in the wall's centre plane, and is no part of the opaque building.
  EXPECT_TRUE(passes(caster, {3, -2, 0.01}, {3, 2, 0.01}));
  EXPECT_NEAR(glass_at(3, 0.01), 2, 1e-6);
  EXPECT_NEAR(glass_at(3.49, 1.19), 2, 1e-6);
  EXPECT_EQ(glass_at(3.51, 1), -1);
  EXPECT_EQ(glass_at(3, 1.21), -1);
}

TEST(BuildingTest, GlassWallsAreSheetsWithTheirDoorwaysOpen) {
  Scene scene = wallWithDoorway();
  scene.walls[0].glass = true;
  scene.slabs.push_back({{-1, -1}, {5, 1}, -0.1, 0});
  const TriangleMesh glass = buildGlass(scene);
  const RayCaster caster(buildMesh(scene), glass);
  EXPECT_EQ(buildMesh(scene).triangles.size(), 12u);  // the slab
  EXPECT_EQ(glass.triangles.size(), 6u);              // left, right, lintel
  EXPECT_TRUE(passes(caster, {0.5, -2, 1}, {0.5, 2, 1}));
  EXPECT_NEAR(caster.castGlass({0.5, -2, 1}, {0, 1, 0}, 0, 100)->range_m, 2, 1e-6);
  EXPECT_FALSE(caster.castGlass({0.5, -2, 1}, {0, 1, 0}, 2.001, 100).has_value());
  EXPECT_FALSE(caster.castGlass({0.5, -2, 1}, {0, 1, 0}, 0, 1.99).has_value());
  EXPECT_FALSE(caster.castGlass({1.5, -2, 1}, {0, 1, 0}, 0, 100).has_value());
  EXPECT_TRUE(caster.castGlass({1.5, -2, 2.5}, {0, 1, 0}, 0, 100).has_value());
  EXPECT_NEAR(caster.distanceToSurface({0.5, -0.25, 1}), 0.25, 1e-9);
}

}  // namespace
}  // namespace sgraphs::simulate
