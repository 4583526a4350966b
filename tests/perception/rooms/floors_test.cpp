#include "perception/rooms/floors.h"

#include <gtest/gtest.h>

#include "tests/perception/rooms/plan_world.h"

namespace sgraphs::test {
namespace {

MapPlane levelPlane(int64_t id, double x0, double x1, double z, double up = 1) {
  MapPlane plane;
  plane.id = PlaneId{id};
  plane.normal_map = {0, 0, up};
  plane.centroid_map = {0.5 * (x0 + x1), 0, z};
  plane.d = -up * z;
  for (const Eigen::Vector2d& p : Polygon2d{{x0, -2}, {x1, -2}, {x1, 2}, {x0, 2}})
    plane.polygon_map.push_back(Eigen::Vector3d(p.x(), p.y(), z).cast<float>());
  return plane;
}

class FloorsTest : public testing::Test {
 protected:
  std::vector<FloorObservation> floors() {
    map_.apply(update_);
    storeys_.step(map_.keyframes());
    return floorsOf(map_, storeys_);
  }

  MapUpdate update_;
  WallMap map_;
  StoreyTracker storeys_{StoreyConfig{}};
};

TEST_F(FloorsTest, HeightIsThatOfThePlanesUnderThePath) {
  for (int i = 0; i < 6; ++i) update_.keyframes.push_back(keyframeAt(i, {1.0 * i, 0}, 0.6));
  update_.planes = {levelPlane(0, -1, 3, 0.02), levelPlane(1, 3, 6, 0.04), levelPlane(2, -1, 6, 2.6, -1),
                    levelPlane(3, 1, 2, 0.75),     // a table
                    levelPlane(4, 30, 90, -0.4)};  // a street outside
  const std::vector<FloorObservation> result = floors();
  ASSERT_EQ(result.size(), 1u);
  EXPECT_TRUE(result[0].has_height);
  EXPECT_NEAR(result[0].z_m, (4 * 0.02 + 3 * 0.04) / 7, 1e-6);
}

TEST_F(FloorsTest, HeightIsUnknownWithoutAPlane) {
  update_.keyframes = {keyframeAt(0, {0, 0})};
  EXPECT_FALSE(floors().at(0).has_height);
}

TEST_F(FloorsTest, WhereNoPlaneWasSeenTheBodysHeightElsewhereTells) {
  double x = 0;
  int64_t id = 0;
  const auto walk = [&](int n, double from, double to) {
    for (int i = 1; i <= n; ++i)
      update_.keyframes.push_back(keyframeAt(id++, {x += 1.0, 0}, from + (to - from) * i / n));
  };
  walk(6, 0.6, 0.6);
  walk(5, 0.6, 3.8);
  walk(6, 3.8, 3.8);
  update_.planes = {levelPlane(0, 0, 6, 0.05)};
  const std::vector<FloorObservation> result = floors();
  ASSERT_EQ(result.size(), 2u);
  EXPECT_TRUE(result[1].has_height);
  EXPECT_NEAR(result[1].z_m, 3.25, 1e-9);
}

TEST_F(FloorsTest, CentreLiesBetweenTheOutermostOpposedWallsWhateverTheHeading) {
  const Eigen::Rotation2Dd turn(0.6);
  const auto wall = [&](int64_t id, const Eigen::Vector2d& a, const Eigen::Vector2d& b, double z = 0) {
    update_.planes.push_back(wallPlane(PlaneId{id}, turn * a, turn * b, z + 0.1, z + 2.5));
  };
  update_.keyframes = {keyframeAt(0, {0, 0})};
  wall(0, {0, 0}, {12, 0});
  wall(1, {12, 0}, {12, 8});
  wall(2, {12, 8}, {0, 8});
  wall(3, {0, 8}, {0, 0});
  wall(4, {5, 0}, {5, 8});         // a partition
  wall(5, {30, 0}, {30, 8}, 3.2);  // of the storey above
  EXPECT_LT((floors().at(0).center_map - turn * Eigen::Vector2d(6, 4)).norm(), 1e-5);
}

}  // namespace
}  // namespace sgraphs::test
