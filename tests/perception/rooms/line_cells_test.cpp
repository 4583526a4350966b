#include "perception/rooms/line_cells.h"

#include <gtest/gtest.h>

namespace sgraphs {
namespace {

OutlineLine lineAt(double angle_rad, double d) {
  return {{std::cos(angle_rad), std::sin(angle_rad)}, d, {}};
}

TEST(LineCellsTest, CellsFillTheFrameAndThePartsAreShared) {
  const std::vector<OutlineLine> lines{lineAt(0, -1), lineAt(0.1, -2), lineAt(1.5, -1.5), lineAt(0.8, -3),
                                       lineAt(2.4, 0.3)};
  const Polygon2d l_shape{{0.5, 0.5}, {3.5, 0.5}, {3.5, 1.5}, {1.5, 1.5}, {1.5, 3.5}, {0.5, 3.5}};
  const std::vector<LineCell> cells =
      cellsOf({Eigen::Vector2d(0, 0), Eigen::Vector2d(4, 4)}, lines, {l_shape});
  double area = 0, covered = 0;
  for (const LineCell& cell : cells) {
    area += cell.area_m2;
    covered += cell.covered_m2;
    EXPECT_GT(cell.area_m2, 0);
    EXPECT_EQ(cell.lines.size(), cell.corners.size());
    const Eigen::Vector2d middle = polygonCentroid(cell.corners);
    for (size_t i = 0; i < lines.size(); ++i)
      EXPECT_EQ((cell.front >> i & 1u) != 0, lines[i].distance(middle) > 0);
  }
  EXPECT_NEAR(area, 16.0, 1e-9);
  EXPECT_NEAR(covered, polygonArea(l_shape), 1e-9);
}

TEST(LineCellsTest, NeighboursDifferInTheLineBetweenThem) {
  const std::vector<LineCell> cells =
      cellsOf({Eigen::Vector2d(0, 0), Eigen::Vector2d(4, 4)}, {lineAt(0, -1), lineAt(M_PI / 2, -2)}, {});
  ASSERT_EQ(cells.size(), 4u);
  for (const LineCell& cell : cells) {
    EXPECT_EQ(std::count(cell.lines.begin(), cell.lines.end(), -1), 2);
    EXPECT_EQ(std::count(cell.lines.begin(), cell.lines.end(), 0), 1);
    EXPECT_EQ(std::count(cell.lines.begin(), cell.lines.end(), 1), 1);
  }
}

}  // namespace
}  // namespace sgraphs
