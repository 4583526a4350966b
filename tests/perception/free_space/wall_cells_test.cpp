#include "perception/free_space/wall_cells.h"

#include <gtest/gtest.h>

namespace sgraphs {
namespace {

// A wall along x at y = 2.05, 2.6 m high, with what is said of its outline (x, z).
MapPlane planeOf(const std::vector<std::pair<float, float>>& outline) {
  MapPlane plane;
  plane.id = PlaneId{0};
  plane.floor = FloorId{0};
  plane.normal_map = -Eigen::Vector3d::UnitY();
  plane.d = 2.05;
  plane.centroid_map = {2.0, 2.05, 1.0};
  for (const auto& [x, z] : outline) plane.polygon_map.emplace_back(x, 2.05f, z);
  return plane;
}

TEST(WallCellsTest, WallIsTracedWhereItIsHighEnough) {
  // A counter of 3 m with a wall of 1 m beside it.
  const MapPlane plane = planeOf({{0, 0}, {4, 0}, {4, 2.4f}, {3, 2.4f}, {3, 0.9f}, {0, 0.9f}});
  const auto trace = wallTrace(plane, 1.0, EvidenceConfig());
  ASSERT_TRUE(trace);
  ASSERT_EQ(trace->pieces.size(), 1u);
  const auto [low, high] = std::minmax(trace->pieces[0].a_map.x(), trace->pieces[0].b_map.x());
  EXPECT_NEAR(low, 3.0, 1e-6);
  EXPECT_NEAR(high, 4.0, 1e-6);
}

TEST(WallCellsTest, DoorsInTheOutlineAreLeftOut) {
  const MapPlane plane =
      planeOf({{0, 0}, {1, 0}, {1, 2.1f}, {2, 2.1f}, {2, 0}, {4, 0}, {4, 2.4f}, {0, 2.4f}});
  const auto trace = wallTrace(plane, 1.0, EvidenceConfig());
  ASSERT_TRUE(trace);
  ASSERT_EQ(trace->pieces.size(), 2u);
  for (const WallTrace::Piece& piece : trace->pieces)
    for (const auto& [x, y] : wallCells(piece, 0.1)) {
      EXPECT_TRUE(x < 10 || x >= 20) << x;
      EXPECT_TRUE(y >= 19 && y <= 21) << y;
    }
}

TEST(WallCellsTest, ColumnsFloorsAndMergedPlanesAreNoWalls) {
  EXPECT_FALSE(wallTrace(planeOf({{0, 0}, {0.5f, 0}, {0.5f, 2.4f}, {0, 2.4f}}), 1.0, EvidenceConfig()));
  MapPlane plane = planeOf({{0, 0}, {4, 0}, {4, 2.4f}, {0, 2.4f}});
  EXPECT_TRUE(wallTrace(plane, 1.0, EvidenceConfig()));
  plane.merged_into = PlaneId{3};
  EXPECT_FALSE(wallTrace(plane, 1.0, EvidenceConfig()));
  plane.merged_into = {};
  plane.normal_map = Eigen::Vector3d::UnitZ();
  EXPECT_FALSE(wallTrace(plane, 1.0, EvidenceConfig()));
}

TEST(WallCellsTest, OneCellPerColumnOfTheWallAtLeast) {
  WallTrace::Piece piece{{0.0, 0.0}, {3.0, 1.7}};
  const auto cells = wallCells(piece, 0.1);
  for (double s = 0.02; s < 0.99; s += 0.01) {
    const Eigen::Vector2d p = piece.a_map + s * (piece.b_map - piece.a_map);
    const std::pair<int, int> cell{static_cast<int>(std::floor(p.x() / 0.1)),
                                   static_cast<int>(std::floor(p.y() / 0.1))};
    EXPECT_NE(std::find(cells.begin(), cells.end(), cell), cells.end()) << s;
  }
}

}  // namespace
}  // namespace sgraphs
