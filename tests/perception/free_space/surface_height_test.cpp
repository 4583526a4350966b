#include "perception/free_space/surface_height.h"

#include <gtest/gtest.h>

#include "tests/perception/free_space/box_world.h"

namespace sgraphs {
namespace {

TEST(SurfaceHeightTest, FindsTheFloor) {
  BoxWorld world;
  world.addRoom({-5, -4}, {5, 4});
  const auto height = SurfaceHeight::measure(world.keyframe(0, bodyAt(0, 0)), Eigen::Vector3d::UnitZ());
  ASSERT_TRUE(height);
  EXPECT_NEAR(*height, BoxWorld::kBodyHeight_m, 0.01);
}

TEST(SurfaceHeightTest, PalletsAreNotTheFloor) {
  BoxWorld world;
  world.addRoom({-6, -6}, {6, 6});
  world.add({2, -3, 0}, {5, 3, 0.3});
  world.add({-5, -3, 0}, {-3, 5, 0.3});
  const auto height = SurfaceHeight::measure(world.keyframe(0, bodyAt(0, 0)), Eigen::Vector3d::UnitZ());
  ASSERT_TRUE(height);
  EXPECT_NEAR(*height, BoxWorld::kBodyHeight_m, 0.01);
}

TEST(SurfaceHeightTest, StaysWhereNoFloorIsInView) {
  BoxWorld hall, closet;
  hall.addRoom({-5, -4}, {5, 4});
  closet.addRoom({-1, -1}, {1, 1});
  const SE3 T = bodyAt(0, 0);
  SurfaceHeight surface;
  EXPECT_FALSE(surface.step(closet.keyframe(0, T), T)) << "no floor seen yet";
  ASSERT_TRUE(surface.step(hall.keyframe(1, T), T));
  const auto height = surface.step(closet.keyframe(2, T), T);
  ASSERT_TRUE(height);
  EXPECT_NEAR(*height, BoxWorld::kBodyHeight_m, 0.01);
}

TEST(SurfaceHeightTest, TiltedBodyKnowsWhereUpIs) {
  BoxWorld world;
  world.addRoom({-5, -4}, {5, 4});
  const SE3 T(so3Exp({0.05, -0.06, 0.3}), {0, 0, BoxWorld::kBodyHeight_m});
  const auto height = SurfaceHeight().step(world.keyframe(0, T), T);
  ASSERT_TRUE(height);
  EXPECT_NEAR(*height, BoxWorld::kBodyHeight_m, 0.02);
}

}  // namespace
}  // namespace sgraphs
