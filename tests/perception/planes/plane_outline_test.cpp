#include "perception/planes/plane_outline.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "perception/planes/plane_grid.h"

namespace sgraphs {
namespace {

std::vector<Eigen::Vector2d> rectangle(double x0, double y0, double x1, double y1, double step = 0.05) {
  std::vector<Eigen::Vector2d> points;
  const int nx = static_cast<int>(std::lround((x1 - x0) / step)),
            ny = static_cast<int>(std::lround((y1 - y0) / step));
  for (int i = 0; i <= nx; ++i)
    for (int j = 0; j <= ny; ++j) points.emplace_back(x0 + (x1 - x0) * i / nx, y0 + (y1 - y0) * j / ny);
  return points;
}

TEST(PlaneOutlineTest, OfALShapeIsTheL) {
  std::vector<Eigen::Vector2d> points = rectangle(0, 0, 4, 1);
  for (const Eigen::Vector2d& p : rectangle(0, 1, 1, 3)) points.push_back(p);
  const Outline outline = outlineOf(points, 0.1, 0.6, 48);
  EXPECT_TRUE(isSimple(outline.polygon));
  // Its inner edges lie between cells.
  EXPECT_GT(polygonArea(outline.polygon), 5.9);
  EXPECT_LT(polygonArea(outline.polygon), 6.6);
  EXPECT_LE(outline.polygon.size(), 8u);
}

TEST(PlaneOutlineTest, GapsBetweenRingsAreClosed) {
  std::vector<Eigen::Vector2d> points;
  for (double y = 0; y <= 2; y += 0.4)
    for (double x = 0; x <= 3; x += 0.05) points.emplace_back(x, y);
  const Outline outline = outlineOf(points, 0.1, 0.6, 48);
  EXPECT_NEAR(polygonArea(outline.polygon), 6.0, 0.05);
  EXPECT_LT(outline.filled, 0.5);
}

TEST(PlaneOutlineTest, AnyCloudGivesASimplePolygonOfFewCorners) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (int trial = 0; trial < 200; ++trial) {
    std::vector<Eigen::Vector2d> points;
    const int blobs = 1 + trial % 7;
    for (int b = 0; b < blobs; ++b) {
      const Eigen::Vector2d at(6 * uniform(random), 3 * uniform(random));
      for (int i = 0; i < 60; ++i)
        points.emplace_back(at + Eigen::Vector2d(uniform(random) - 0.5, 2 * uniform(random) - 1));
    }
    const Outline outline = outlineOf(points, 0.1, 0.6, 20);
    ASSERT_GE(outline.polygon.size(), 3u);
    EXPECT_LE(outline.polygon.size(), 20u);
    EXPECT_TRUE(isSimple(outline.polygon)) << trial;
    EXPECT_GT(polygonArea(outline.polygon), 0.0);
    EXPECT_LE(polygonArea(outline.polygon), polygonArea(convexHull(points)) + 0.4);
  }
}

TEST(PlaneOutlineTest, OfPointsOnALineHasNoArea) {
  const Outline outline = outlineOf({{0, 0}, {1, 0}, {2, 0}}, 0.1, 0.6, 48);
  EXPECT_LT(polygonArea(outline.polygon), 0.01);
  EXPECT_TRUE(outlineOf({}, 0.1, 0.6, 48).polygon.size() < 5);
}

TEST(PlaneOutlineTest, ABowTieIsNotSimple) {
  EXPECT_TRUE(isSimple({{0, 0}, {1, 0}, {1, 1}, {0, 1}}));
  EXPECT_FALSE(isSimple({{0, 0}, {1, 1}, {1, 0}, {0, 1}}));
}

TEST(PlaneOutlineTest, ConvexHullIsCounterClockwise) {
  const Polygon hull = convexHull({{0, 0}, {2, 0}, {1, 0.2}, {2, 2}, {0, 2}, {1, 1}, {0, 0}});
  EXPECT_EQ(hull, (Polygon{{0, 0}, {2, 0}, {2, 2}, {0, 2}}));
  EXPECT_TRUE(convexHull({{0, 0}, {1, 1}, {2, 2}}).empty());
}

TEST(PlaneGridTest, DilationLinksCellsUpToTwiceItsRadius) {
  for (const auto& [gap_m, regions] : {std::pair{0.5, 1}, std::pair{0.8, 2}}) {
    std::vector<Eigen::Vector2d> points = rectangle(0, 0, 1, 1);
    for (const Eigen::Vector2d& p : rectangle(1 + gap_m, 0, 2 + gap_m, 1)) points.push_back(p);
    PlaneGrid grid(points, 0.1, 4);
    grid.dilate(3);
    int found = 0;
    grid.regions(&found);
    EXPECT_EQ(found, regions) << gap_m;
  }
}

TEST(PlaneGridTest, ErosionUndoesTheDilationOfARectangle) {
  PlaneGrid grid(rectangle(0, 0, 2, 1), 0.1, 4);
  const int before = grid.count();
  EXPECT_EQ(before, 200);
  grid.dilate(3);
  EXPECT_EQ(grid.count(), 26 * 16);
  grid.erode(3);
  EXPECT_EQ(grid.count(), before);
}

TEST(PlaneGridTest, KnowsWhichPlacesAreFilled) {
  PlaneGrid grid({{0, 0}, {1, 0}, {1, 1}}, 0.1, 2);
  EXPECT_TRUE(grid.isFilled({0.99, 0.99}));
  EXPECT_FALSE(grid.isFilled({0.5, 0.5}));
  EXPECT_FALSE(grid.isFilled({1e9, -1e300}));
  EXPECT_FALSE(grid.isFilled({NAN, 0}));
}

}  // namespace
}  // namespace sgraphs
