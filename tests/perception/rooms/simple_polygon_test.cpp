#include "perception/rooms/simple_polygon.h"

#include <gtest/gtest.h>

namespace sgraphs {
namespace {

const Polygon2d kU{{0, 0}, {3, 0}, {3, 3}, {2, 3}, {2, 1}, {1, 1}, {1, 3}, {0, 3}};

TEST(SimplePolygonTest, ClippedToTwoPiecesHasTheirArea) {
  EXPECT_NEAR(polygonArea(clipped(kU, {0, 1}, -2)), 2.0, 1e-12);  // the tips, y > 2
  EXPECT_NEAR(polygonArea(clipped(kU, {0, -1}, 2)), 5.0, 1e-12);  // the rest
  EXPECT_TRUE(clipped(kU, {1, 0}, -5).empty());
}

TEST(SimplePolygonTest, PointsAreInsideOrHaveADistance) {
  EXPECT_TRUE(contains(kU, {0.5, 2.5}));
  EXPECT_FALSE(contains(kU, {1.5, 2.5}));
  EXPECT_EQ(distanceTo(kU, {0.5, 2.5}), 0);
  EXPECT_NEAR(distanceTo(kU, {1.5, 2.0}), 0.5, 1e-12);
  EXPECT_NEAR(distanceTo(kU, {4, 4}), std::sqrt(2.0), 1e-12);
}

TEST(SimplePolygonTest, SharedAreaOfPolygonsThatAreNotConvex) {
  EXPECT_NEAR(sharedArea(kU, kU), polygonArea(kU), 1e-9);
  Polygon2d moved = kU;
  for (Eigen::Vector2d& p : moved) p += Eigen::Vector2d(1, 1);
  EXPECT_NEAR(sharedArea(kU, moved), 1.0, 1e-9);  // its foot in the right arm
  EXPECT_EQ(sharedArea(kU, {{9, 9}, {10, 9}, {10, 10}}), 0);
}

TEST(SimplePolygonTest, StraightenedDropsStepsAndKeepsCorners) {
  Polygon2d steps;
  for (int i = 0; i < 20; ++i) {
    steps.emplace_back(0.1 * i, 0.1 * i);
    steps.emplace_back(0.1 * i + 0.1, 0.1 * i);
  }
  steps.emplace_back(5.0, 2.0);
  const std::vector<size_t> kept = straightened(steps, 0.12);
  ASSERT_EQ(kept.size(), 3u);
  EXPECT_NEAR(steps[kept[1]].x(), 2.0, 0.11);
}

}  // namespace
}  // namespace sgraphs
