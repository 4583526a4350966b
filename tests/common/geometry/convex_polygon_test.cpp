#include "common/geometry/convex_polygon.h"

#include <gtest/gtest.h>

namespace sgraphs {
namespace {

Polygon2d square(double x, double y, double side) {
  return {{x, y}, {x + side, y}, {x + side, y + side}, {x, y + side}};
}

TEST(ConvexPolygonTest, HullOfAGridIsItsCorners) {
  Polygon2d points;
  for (int i = 0; i < 5; ++i)
    for (int k = 0; k < 4; ++k) points.emplace_back(i, k);
  const Polygon2d hull = convexHull(points);
  EXPECT_EQ(hull.size(), 4u);
  EXPECT_DOUBLE_EQ(polygonArea(hull), 12.0);
}

TEST(ConvexPolygonTest, PointsOnALineHaveNoArea) {
  EXPECT_LT(convexHull({{0, 0}, {1, 1}, {2, 2}, {3, 3}}).size(), 3u);
  EXPECT_TRUE(convexHull({}).empty());
}

TEST(ConvexPolygonTest, OverlapOfShiftedSquares) {
  EXPECT_NEAR(overlapArea(square(0, 0, 2), square(1, 1, 2)), 1.0, 1e-12);
  EXPECT_NEAR(overlapArea(square(0, 0, 2), square(0.5, 0.5, 1)), 1.0, 1e-12);
  EXPECT_EQ(overlapArea(square(0, 0, 2), square(3, 0, 2)), 0.0);
}

TEST(ConvexPolygonTest, GapIsZeroWhereTheyMeet) {
  EXPECT_NEAR(gapBetween(square(0, 0, 2), square(3, 0, 2)), 1.0, 1e-12);
  EXPECT_NEAR(gapBetween(square(0, 0, 1), square(4, 5, 1)), 5.0, 1e-12);
  EXPECT_EQ(gapBetween(square(0, 0, 2), square(1, 1, 2)), 0.0);
  EXPECT_EQ(gapBetween(square(0, 0, 4), square(1, 1, 1)), 0.0);
}

TEST(ConvexPolygonTest, CentroidIsThatOfTheArea) {
  EXPECT_TRUE(polygonCentroid({{0, 0}, {3, 0}, {0, 3}}).isApprox(Eigen::Vector2d(1, 1), 1e-12));
  EXPECT_TRUE(polygonCentroid(square(4, 2, 2)).isApprox(Eigen::Vector2d(5, 3), 1e-12));
}

TEST(ConvexPolygonTest, SimplifiedKeepsWhatHoldsTheArea) {
  Polygon2d round;
  for (int i = 0; i < 100; ++i) round.emplace_back(std::cos(0.0628 * i), std::sin(0.0628 * i));
  const Polygon2d few = simplified(convexHull(round), 16);
  EXPECT_EQ(few.size(), 16u);
  EXPECT_GT(polygonArea(few), 0.96 * polygonArea(convexHull(round)));
}

}  // namespace
}  // namespace sgraphs
