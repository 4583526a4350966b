#include "backend/output/map_cloud.h"

#include <gtest/gtest.h>

namespace sgraphs {
namespace {

void addKeyframe(SituationalGraph& graph, int64_t id, const SE3& T_map_body, FloorId floor,
                 std::vector<KeyframePoint> points) {
  auto keyframe = std::make_shared<Keyframe>();
  keyframe->points = std::move(points);
  graph.keyframes[{id}] = {{id}, {id}, T_map_body, T_map_body, floor, keyframe};
}

TEST(MapCloudTest, CentroidIsWeightedByCountsOverKeyframes) {
  SituationalGraph graph;
  const SE3 moved(Eigen::Quaterniond::Identity(), {1, 0, 0});
  addKeyframe(graph, 0, SE3{}, {}, {{{1.01f, 0.01f, 0.01f}, 0, 1}});
  addKeyframe(graph, 1, moved, {}, {{{0.03f, 0.01f, 0.01f}, 0, 3}});
  const auto map = buildMap(graph, 0.05);
  ASSERT_EQ(map.size(), 1u);
  EXPECT_NEAR(map[0].position_map.x(), (1.01 + 3 * 1.03) / 4, 1e-6);
  EXPECT_EQ(map[0].weight, 4);
  EXPECT_EQ(map[0].floor, FloorId{0});
}

TEST(MapCloudTest, NoPointIsDropped) {
  SituationalGraph graph;
  addKeyframe(graph, 0, SE3{}, {}, {{{0, 0, 0}, 0, 1}, {{30, 0, 0}, 0, 1}, {{0, -9, 4}, 0, 1}});
  EXPECT_EQ(buildMap(graph, 0.05).size(), 3u);
}

TEST(MapCloudTest, StoreysDoNotMix) {
  SituationalGraph graph;
  addKeyframe(graph, 0, SE3{}, {0}, {{{0.01f, 0, 0}, 0, 1}});
  addKeyframe(graph, 1, SE3{}, {1}, {{{0.02f, 0, 0}, 0, 1}});
  const auto map = buildMap(graph, 0.05);
  ASSERT_EQ(map.size(), 2u);
  EXPECT_EQ(map[0].floor, FloorId{0});
  EXPECT_EQ(map[1].floor, FloorId{1});
}

TEST(MapCloudTest, OrderComesFromVoxelsNotFromArrival) {
  SituationalGraph forward, backward;
  addKeyframe(forward, 0, SE3{}, {}, {{{1, 0, 0}, 0, 1}, {{2, 0, 0}, 0, 1}, {{0, 3, 1}, 0, 1}});
  addKeyframe(backward, 0, SE3{}, {}, {{{0, 3, 1}, 0, 1}, {{2, 0, 0}, 0, 1}, {{1, 0, 0}, 0, 1}});
  const auto a = buildMap(forward, 0.05), b = buildMap(backward, 0.05);
  ASSERT_EQ(a.size(), b.size());
  for (size_t i = 0; i < a.size(); ++i) EXPECT_EQ(a[i].position_map, b[i].position_map);
}

}  // namespace
}  // namespace sgraphs
