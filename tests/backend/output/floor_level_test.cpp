#include "backend/output/floor_level.h"

#include <gtest/gtest.h>

#include "tests/backend/output/synthetic_run.h"

namespace sgraphs {
namespace {

TEST(FloorLevelTest, WalkingSurfaceIsMeasured) {
  const auto run = test::makeSyntheticRun();
  const auto floors = describeFloors(run->graph, buildMap(run->graph, 0.05));
  ASSERT_EQ(floors.size(), 1u);
  const FloorNode& floor = floors.at({0});
  ASSERT_TRUE(floor.has_height);
  EXPECT_NEAR(floor.z_m, run->room.min.z(), 0.01);
  EXPECT_NEAR(floor.center_map.x(), 2, 0.5);
  EXPECT_NEAR(floor.center_map.y(), 1.5, 0.5);
}

TEST(FloorLevelTest, TiltedMapIsMeasuredAlongUp) {
  const auto run = test::makeSyntheticRun();
  const SE3 tilt(Eigen::Quaterniond(Eigen::AngleAxisd(0.05, Eigen::Vector3d(1, 2, 0).normalized())),
                 {0, 0, 0});
  for (auto& [id, node] : run->graph.keyframes) node.T_map_body = tilt * node.T_map_body;
  run->graph.up_map = tilt.rotation * Eigen::Vector3d::UnitZ();
  const auto floors = describeFloors(run->graph, buildMap(run->graph, 0.05));
  const FloorNode& floor = floors.at({0});
  ASSERT_TRUE(floor.has_height);
  const Eigen::Vector3d on_floor(floor.center_map.x(), floor.center_map.y(), floor.z_m);
  EXPECT_NEAR(run->graph.up_map.dot(on_floor), run->room.min.z(), 0.015);
  const StoreyHeight height(run->graph, floor);
  EXPECT_NEAR(height.above(tilt * Eigen::Vector3d(6, 5, run->room.min.z() + 1)), 1.0, 0.015);
}

TEST(FloorLevelTest, WallsAloneGiveNoHeight) {
  const auto run = test::makeSyntheticRun();
  for (auto& [id, node] : run->graph.keyframes) {
    auto keyframe = std::make_shared<Keyframe>(*node.keyframe);
    std::erase_if(keyframe->points, [](const KeyframePoint& p) { return p.position_body.z() < -0.45f; });
    node.keyframe = keyframe;
  }
  EXPECT_FALSE(describeFloors(run->graph, buildMap(run->graph, 0.05)).at({0}).has_height);
}

TEST(FloorLevelTest, TheGraphsOwnHeightIsKept) {
  const auto run = test::makeSyntheticRun();
  run->graph.floors[{0}] = {{0}, {1, 2}, true, -0.75};
  EXPECT_EQ(describeFloors(run->graph, buildMap(run->graph, 0.05)).at({0}).z_m, -0.75);
}

TEST(FloorLevelTest, EachStoreyOfAKeyframeIsDescribed) {
  const auto run = test::makeSyntheticRun();
  run->graph.keyframes.rbegin()->second.floor = {2};
  const auto floors = describeFloors(run->graph, buildMap(run->graph, 0.05));
  EXPECT_EQ(floors.size(), 2u);
  EXPECT_TRUE(floors.contains({2}));
}

}  // namespace
}  // namespace sgraphs
