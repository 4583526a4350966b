#include "tools/eval/plan_polygon.h"

#include <gtest/gtest.h>

#include "tests/tools/eval/house.h"

namespace sgraphs {
namespace {

using test::box;

const Corners kEll = {{0, 0}, {4, 0}, {4, 2}, {2, 2}, {2, 4}, {0, 4}};

Corners turned(const Corners& polygon, double angle_rad) {
  Corners result;
  for (const auto& p : polygon) result.push_back(Eigen::Rotation2Dd(angle_rad) * p);
  return result;
}

TEST(PlanPolygonTest, AreaOfABoxAndOfAnEll) {
  EXPECT_NEAR(areaOf(box(1, 2, 4, 4)), 6, 1e-12);
  EXPECT_NEAR(areaOf(kEll), 12, 1e-12);
  EXPECT_NEAR(areaOf(turned(kEll, 0.6)), 12, 1e-9);
}

TEST(PlanPolygonTest, TheWayAroundDoesNotMatter) {
  Corners reversed(kEll.rbegin(), kEll.rend());
  EXPECT_NEAR(intersectionOverUnion(kEll, reversed), 1, 1e-12);
}

// The square's upper right quarter is cut out of the ell.
TEST(PlanPolygonTest, NotchesAreNotShared) {
  for (const double angle_rad : {0.0, 0.3, 2.0}) {
    EXPECT_NEAR(sharedArea({turned(kEll, angle_rad)}, {turned(box(1, 1, 3, 3), angle_rad)}), 3, 1e-9);
    EXPECT_NEAR(sharedArea({turned(kEll, angle_rad)}, {turned(box(2.5, 2.5, 4, 4), angle_rad)}), 0, 1e-9);
  }
}

// A square turned by 45 degrees about the centre of one of its size leaves a regular octagon.
TEST(PlanPolygonTest, CrossingEdgesAreCutExactly) {
  const Corners square = box(-1, -1, 1, 1);
  EXPECT_NEAR(sharedArea({square}, {turned(square, M_PI / 4)}), 8 * (std::sqrt(2.0) - 1), 1e-12);
}

TEST(PlanPolygonTest, WhatSeveralCoverCountsOnce) {
  EXPECT_NEAR(sharedArea({box(0, 0, 2, 2), box(1, 0, 3, 2)}, {box(0, 0, 10, 1)}), 3, 1e-12);
  EXPECT_EQ(sharedArea({}, {box(0, 0, 1, 1)}), 0);
}

TEST(PlanPolygonTest, IntersectionOverUnionOfShiftedBoxes) {
  EXPECT_NEAR(intersectionOverUnion(box(0, 0, 3, 1), box(1, 0, 4, 1)), 0.5, 1e-12);
  EXPECT_EQ(intersectionOverUnion(box(0, 0, 1, 1), box(2, 0, 3, 1)), 0);
}

TEST(PlanPolygonTest, InsideOfAnEll) {
  EXPECT_TRUE(contains(kEll, {1, 3}));
  EXPECT_FALSE(contains(kEll, {3, 3}));
  EXPECT_FALSE(contains({}, {0, 0}));
}

TEST(PlanPolygonTest, OutlinesOfNoRoomAreRefused) {
  EXPECT_EQ(whyNoOutline(kEll), "");
  EXPECT_EQ(whyNoOutline({{0, 0}, {1, 0}}), "has less than three corners");
  EXPECT_EQ(whyNoOutline({{0, 0}, {1, 0}, {2, 0}}), "has no area");
  EXPECT_EQ(whyNoOutline({{0, 0}, {2, 2}, {2, 0}, {0, 2}}), "has an outline that crosses itself");
}

TEST(PlanPolygonTest, ClosedOutlinesAreAccepted) {
  Corners closed = kEll;
  closed.push_back(closed.front());
  EXPECT_EQ(whyNoOutline(closed), "");
  EXPECT_NEAR(areaOf(closed), 12, 1e-12);
}

}  // namespace
}  // namespace sgraphs
