#include "perception/loops/wall_layout.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace sgraphs {
namespace {

constexpr double kTurn = std::numbers::pi;

// Walls of a room that is like itself in no other pose: 6 x 4 m with a niche, seen from inside.
std::vector<WallPoint> room(double x0 = 0, double y0 = 0) {
  std::vector<WallPoint> walls;
  const auto face = [&](double ax, double ay, double bx, double by, double heading) {
    const int n = static_cast<int>(std::hypot(bx - ax, by - ay) / 0.2);
    for (int i = 0; i <= n; ++i) {
      const double s = static_cast<double>(i) / n;
      walls.push_back({Eigen::Vector2d(x0 + ax + s * (bx - ax), y0 + ay + s * (by - ay)).cast<float>(),
                       static_cast<float>(heading)});
    }
  };
  face(0, 0, 6, 0, 0.5 * kTurn);
  face(6, 0, 6, 4, kTurn);
  face(6, 4, 3, 4, -0.5 * kTurn);
  face(3, 4, 3, 5.2, kTurn);
  face(3, 5.2, 1.5, 5.2, -0.5 * kTurn);
  face(1.5, 5.2, 1.5, 4, 0);
  face(1.5, 4, 0, 4, -0.5 * kTurn);
  face(0, 4, 0, 0, 0);
  return walls;
}

// The walls as a body at p with this heading sees them.
std::vector<WallPoint> seenFrom(const std::vector<WallPoint>& walls, const Eigen::Vector2d& p, double yaw) {
  const Eigen::Rotation2D<float> R(static_cast<float>(-yaw));
  std::vector<WallPoint> out;
  out.reserve(walls.size());
  for (const WallPoint& w : walls)
    out.push_back({R * (w.position - p.cast<float>()), w.heading_rad - static_cast<float>(yaw)});
  return out;
}

class WallLayoutTest : public testing::TestWithParam<double> {};

TEST_P(WallLayoutTest, AnyHeadingIsFoundWithItsPlace) {
  WallLayout layout({3, 2}, 15);
  for (const WallPoint& w : room()) layout.add(w);
  const Eigen::Vector2d p(4.1, 1.3);
  LayoutSearch where;
  where.centre_map = {3, 2};
  where.radius_m = 3;
  where.yaw_range_rad = kTurn;
  const auto found = layout.search(seenFrom(room(), p, GetParam()), where);
  ASSERT_FALSE(found.empty());
  EXPECT_LT((found.front().position_map - p).norm(), 0.35);
  EXPECT_LT(std::abs(std::remainder(found.front().yaw_rad - GetParam(), 2 * kTurn)), 0.06);
  EXPECT_GT(found.front().score, 0.8);
}
INSTANTIATE_TEST_SUITE_P(Headings, WallLayoutTest, testing::Values(0.0, 0.4, 1.2, 2.0, 3.1, -0.9, -2.4));

TEST(WallLayoutSearchTest, RoomsThatLookAlikeAreAllFound) {
  WallLayout layout({8, 2}, 25);
  for (const double x : {0.0, 8.0, 16.0})
    for (const WallPoint& w : room(x)) layout.add(w);
  LayoutSearch where;
  where.centre_map = {11, 2};
  where.radius_m = 9.5;
  where.yaw_range_rad = 0.1;
  const auto found = layout.search(seenFrom(room(), {3, 2}, 0), where);
  ASSERT_GE(found.size(), 3U);
  for (const double x : {3.0, 11.0, 19.0})
    EXPECT_TRUE(std::any_of(found.begin(), found.end(), [&](const LayoutMatch& m) {
      return (m.position_map - Eigen::Vector2d(x, 2)).norm() < 0.3;
    })) << x;
}

TEST(WallLayoutSearchTest, NothingIsFoundOutsideTheRadius) {
  WallLayout layout({8, 2}, 25);
  for (const WallPoint& w : room(8)) layout.add(w);
  LayoutSearch where;
  where.centre_map = {3, 2};
  where.radius_m = 4;
  for (const LayoutMatch& m : layout.search(seenFrom(room(), {3, 2}, 0), where))
    EXPECT_LE((m.position_map - where.centre_map).norm(), 4.6);
}

TEST(WallLayoutSearchTest, TheBackOfAWallIsAnotherWall) {
  WallLayout layout({0, 0}, 10);
  std::vector<WallPoint> turned_away = room();
  for (WallPoint& w : turned_away) w.heading_rad += static_cast<float>(kTurn);
  for (const WallPoint& w : turned_away) layout.add(w);
  LayoutSearch where;
  where.centre_map = {3, 2};
  where.radius_m = 0.5;
  EXPECT_TRUE(layout.search(seenFrom(room(), {3, 2}, 0), where).empty());
}

TEST(WallLayoutSearchTest, NothingMatchesNothing) {
  const WallLayout layout({0, 0}, 10);
  EXPECT_TRUE(layout.search({}, LayoutSearch()).empty());
  EXPECT_TRUE(layout.search(room(), LayoutSearch()).empty());
}

}  // namespace
}  // namespace sgraphs
