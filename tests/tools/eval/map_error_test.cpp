#include "tools/eval/map_error.h"

#include <gtest/gtest.h>

#include "common/base/error.h"
#include "tests/tools/eval/truth_fixture.h"

namespace sgraphs {
namespace {

// A wall of 4 m by 2 m in the plane x = 0, far from the origin as surveyed buildings are.
const Eigen::Vector3d kCorner(1000, -2000, 50);
const TriangleMesh kWall = test::rectangle(kCorner, {0, 4, 0}, {0, 0, 2});
const std::vector<Eigen::Vector3d> kPath = {kCorner + Eigen::Vector3d(2, 1, 1),
                                            kCorner + Eigen::Vector3d(2, 3, 1)};

std::vector<Eigen::Vector3d> pointsOnWall(double width_m, double off_m) {
  std::vector<Eigen::Vector3d> points;
  for (double y = 0.01; y < width_m; y += 0.04)
    for (double z = 0.01; z < 2; z += 0.04) points.push_back(kCorner + Eigen::Vector3d(off_m, y, z));
  return points;
}

TEST(MapErrorTest, OffsetOfThreeCentimetresIsTheRmse) {
  const MapError error = mapError(kWall, pointsOnWall(4, 0.03), kPath);
  EXPECT_NEAR(error.distance_m.rmse, 0.03, 1e-6);
  EXPECT_NEAR(error.distance_m.max, 0.03, 1e-6);
  EXPECT_NEAR(error.visible_area_m2, 8, 1e-6);
  EXPECT_GT(error.completeness, 0.99);
}

TEST(MapErrorTest, HalfCoveredWallIsHalfComplete) {
  EXPECT_NEAR(mapError(kWall, pointsOnWall(2, 0), kPath).completeness, 0.5, 0.02);
}

TEST(MapErrorTest, PointsBeyondFiveCentimetresDoNotCover) {
  EXPECT_EQ(mapError(kWall, pointsOnWall(4, 0.06), kPath).completeness, 0);
}

TEST(MapErrorTest, HiddenAndFarSurfacesAreNotAskedFor) {
  TriangleMesh mesh = kWall;
  // Behind the wall, and 12 m in front of the path.
  for (const double x : {-1.0, 14.0}) {
    const TriangleMesh other = test::rectangle(kCorner + Eigen::Vector3d(x, 1, 0.5), {0, 1, 0}, {0, 0, 1});
    const int first = static_cast<int>(mesh.vertices.size());
    mesh.vertices.insert(mesh.vertices.end(), other.vertices.begin(), other.vertices.end());
    for (const auto& t : other.triangles) mesh.triangles.push_back((t.array() + first).matrix());
  }
  EXPECT_NEAR(mapError(mesh, pointsOnWall(4, 0), kPath).visible_area_m2, 8, 1e-6);
}

TEST(MapErrorTest, PathsThatComeByAgainAskForNoMore) {
  std::vector<Eigen::Vector3d> path;
  for (int lap = 0; lap < 3; ++lap)
    for (int i = 0; i < 100; ++i) path.push_back(kCorner + Eigen::Vector3d(9, 0.1 * i, 1));
  const std::vector<Eigen::Vector3d> once(path.begin(), path.begin() + 100);
  const MapError thrice = mapError(kWall, pointsOnWall(2, 0), path);
  EXPECT_EQ(thrice.visible_area_m2, mapError(kWall, pointsOnWall(2, 0), once).visible_area_m2);
  EXPECT_GT(thrice.visible_area_m2, 7.9);
}

TEST(MapErrorTest, EmptyMapIsAnError) {
  EXPECT_THROW(mapError(kWall, {}, kPath), Error);
}

TEST(MeshQueryTest, DistanceGoesToFacesEdgesAndCorners) {
  const MeshQuery query(kWall);
  EXPECT_NEAR(*query.distance(kCorner + Eigen::Vector3d(-0.5, 1, 1), 10), 0.5, 1e-9);
  EXPECT_NEAR(*query.distance(kCorner + Eigen::Vector3d(0.3, -0.4, 1), 10), 0.5, 1e-9);
  EXPECT_NEAR(*query.distance(kCorner + Eigen::Vector3d(2, 5, 4), 10), 3, 1e-9);
  EXPECT_FALSE(query.distance(kCorner + Eigen::Vector3d(2, 1, 1), 1.5));
}

TEST(MeshQueryTest, WallsHideWhatIsBehind) {
  const MeshQuery query(kWall);
  const Eigen::Vector3d front = kCorner + Eigen::Vector3d(1, 1, 1);
  EXPECT_TRUE(query.occluded(front, kCorner + Eigen::Vector3d(-1, 1, 1), 0.005));
  EXPECT_FALSE(query.occluded(front, kCorner + Eigen::Vector3d(0, 1, 1), 0.005));
  EXPECT_FALSE(query.occluded(front, kCorner + Eigen::Vector3d(-1, 9, 1), 0.005));
}

TEST(SurfaceSamplesTest, AreaIsKeptAtTheSpacing) {
  double area = 0;
  const auto samples = sampleSurface(kWall, 0.14);
  for (const auto& sample : samples) area += sample.area_m2;
  EXPECT_NEAR(area, 8, 1e-9);
  EXPECT_GT(samples.size(), 800u);  // a triangle of longest edge 0.14 m has at most 0.01 m2
}

}  // namespace
}  // namespace sgraphs
