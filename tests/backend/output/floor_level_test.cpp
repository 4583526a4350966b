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

// Keyframes 0 and 1 on one floor, a ride from 1 to 2, stairs from 2 to 3, a ride back to 4.
TEST(FloorLevelTest, HeightsAcrossRidesAreUnknownUntilALoopMeasuresThem) {
  SituationalGraph graph;
  for (int64_t i = 0; i < 5; ++i) graph.keyframes[{i}].id = {i};
  for (const auto& [id, floor] : {std::pair{2, 1}, std::pair{3, 2}, std::pair{4, 3}})
    graph.keyframes[{id}].floor = {floor};
  graph.keyframes[{0}].floor = graph.keyframes[{1}].floor = {0};
  for (int64_t i = 1; i < 5; ++i) {
    RelativePose z;
    z.from = {i - 1};
    z.to = {i};
    z.covariance = 1e-4 * Matrix6d::Identity();
    if (i == 2 || i == 4) z.covariance(2, 2) = 400;
    graph.relative_poses.push_back({i, z});
  }
  EXPECT_EQ(floorsOfUnknownHeight(graph), (std::set<FloorId>{{1}, {2}, {3}}));
  RelativePose loop;
  loop.kind = RelativePoseKind::kLoop;
  loop.from = {0};
  loop.to = {4};
  loop.covariance = 1e-4 * Matrix6d::Identity();
  graph.relative_poses.push_back({9, loop});
  EXPECT_EQ(floorsOfUnknownHeight(graph), (std::set<FloorId>{{1}, {2}}));
  graph.keyframes[{4}].floor = {0};
  EXPECT_EQ(floorsOfUnknownHeight(graph), (std::set<FloorId>{{1}, {2}}));
}

}  // namespace
}  // namespace sgraphs
