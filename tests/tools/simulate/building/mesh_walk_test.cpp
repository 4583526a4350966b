#include "tools/simulate/building/mesh_walk.h"

#include <gmock/gmock.h>

namespace sgraphs::simulate {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr double kTop_m = 0.85;

// Floor at z = 0 under a roof, a wall at x = 2 with a gap of 1 m around y = 0, a table at (0, 3).
TriangleMesh house() {
  TriangleMesh mesh;
  mesh.addBox({0, 0, -0.1}, {10, 10, 0.2}, 0, 50);
  mesh.addBox({0, 0, 2.6}, {10, 10, 0.2}, 0, 50);
  mesh.addBox({2, 2.75, 1.25}, {0.1, 4.5, 2.5}, 0, 50);
  mesh.addBox({2, -2.75, 1.25}, {0.1, 4.5, 2.5}, 0, 50);
  mesh.addBox({0, 3, 0.73}, {1.6, 0.9, 0.03}, 0, 50);
  return mesh;
}

std::string faultOf(const std::vector<Eigen::Vector2d>& waypoints, double floor_z_m = 0) {
  const RayCaster mesh(house());
  WalkPath path;
  for (const auto& xy : waypoints) path.waypoints.push_back({xy, 0, 0});
  return meshWalkFault(mesh, path, floor_z_m, kTop_m).value_or("");
}

TEST(MeshWalkTest, SurfacesToWalkOnHaveRoomAboveThem) {
  const RayCaster mesh(house());
  using testing::DoubleNear;
  EXPECT_THAT(walkingSurfaces(mesh, {-3, 0}, -0.2, 2.7),
              ElementsAre(DoubleNear(0, 1e-4), DoubleNear(2.7, 1e-4)));
  // Under the table nobody walks; on it somebody might.
  EXPECT_THAT(walkingSurfaces(mesh, {0, 3}, -0.2, 2.7),
              ElementsAre(DoubleNear(0.745, 1e-4), DoubleNear(2.7, 1e-4)));
  EXPECT_THAT(walkingSurfaces(mesh, {30, 0}, -0.2, 2.7), testing::IsEmpty());
}

TEST(MeshWalkTest, ThroughTheGapIsFree) {
  EXPECT_EQ(faultOf({{-3, 0}, {4, 0}}), "");
  EXPECT_EQ(faultOf({{-3, -3}}), "");
}

TEST(MeshWalkTest, WaypointTooCloseIsNamedWithItsDistance) {
  EXPECT_THAT(faultOf({{-3, 0}, {1.75, 3}}),
              AllOf(HasSubstr("path.waypoints[1] at (1.75, 3.00)"), HasSubstr("0.20 m from the mesh")));
}

TEST(MeshWalkTest, LegThroughAWallIsNamed) {
  EXPECT_THAT(faultOf({{-3, 0}, {0, -3}, {4, -3}}),
              AllOf(HasSubstr("from path.waypoints[1] to path.waypoints[2]"), HasSubstr("the mesh")));
  // Two samples on either side of a sheet without thickness.
  TriangleMesh sheet;
  sheet.addQuad({Eigen::Vector3d(0, -2, 0), {0, 2, 0}, {0, 2, 2}, {0, -2, 2}}, 50);
  WalkPath path;
  path.clearance_m = 0.01;
  path.waypoints = {{{-3, 0.1}, 0, 0}, {{3, 0.1}, 0, 0}};
  const auto fault = meshWalkFault(RayCaster(sheet), path, 0, kTop_m);
  ASSERT_TRUE(fault.has_value());
  EXPECT_THAT(*fault, HasSubstr("goes through the mesh"));
}

TEST(MeshWalkTest, TableTopIsInTheWayAndTheRoofIsNot) {
  EXPECT_THAT(faultOf({{-3, 3}, {1.4, 3}}), HasSubstr("the mesh"));
  EXPECT_EQ(faultOf({{-3, 3}}, 2.7), "");
}

TEST(MeshWalkTest, StairsCanBeClimbedAndAreAWallToThoseWhoDoNotClimb) {
  TriangleMesh stairs;
  stairs.addBox({0, 0, -0.1}, {20, 4, 0.2}, 0, 50);
  for (int i = 0; i < 10; ++i)  // steps of 0.17 m, 0.28 m deep, from x = 0 on
    stairs.addBox({0.28 * i + 3.64 - 0.14 * i, 0, 0.085 * (i + 1)}, {7 - 0.28 * i, 2, 0.17 * (i + 1)}, 0, 50);
  const RayCaster mesh(stairs);
  WalkPath path;
  path.waypoints = {{{-2, 0}, 0, 0}, {{0, 0}, 0, 0}, {{2.8, 0}, 0, 1.7}, {{4, 0}, 0, 1.7}};
  EXPECT_EQ(meshWalkFault(mesh, path, 0, kTop_m).value_or(""), "");
  for (Waypoint& waypoint : path.waypoints) waypoint.rise_m = 0;
  EXPECT_TRUE(meshWalkFault(mesh, path, 0, kTop_m).has_value());
}

}  // namespace
}  // namespace sgraphs::simulate
