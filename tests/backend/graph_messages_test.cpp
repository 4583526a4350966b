#include "backend/graph_messages.h"
#include "lcmtypes/convert/chunks.h"

#include <gtest/gtest.h>

#include "lcmtypes/convert/convert.h"
#include "tests/backend/output/synthetic_planes.h"
#include "tests/lcmtypes/through_bytes.h"

namespace sgraphs {
namespace {

constexpr Time kTime{5'000'000};

SituationalGraph roomGraph() {
  auto run = test::makeSyntheticRun();
  test::addRoomPlanes(run->room, run->graph);
  return run->graph;
}

// A graph whose snapshot takes several messages.
SituationalGraph largeGraph(int64_t num_planes, size_t corners) {
  SituationalGraph graph = roomGraph();
  const PlaneNode wall = graph.planes.at({0});
  for (int64_t i = 0; i < num_planes; ++i) {
    PlaneNode plane = wall;
    plane.id = {100 + i};
    while (plane.polygon_map.size() < corners) plane.polygon_map.push_back(plane.polygon_map.back());
    graph.planes[plane.id] = plane;
  }
  return graph;
}

RoundOutput outputOf(std::vector<PlaneId> planes) {
  RoundOutput output;
  output.changed = {{2}, {3}};
  output.changed_planes = std::move(planes);
  output.graph_digest = std::string(64, 'a');
  return output;
}

TEST(GraphMessagesTest, AnUpdateCarriesWhatTheRoundChanged) {
  const SituationalGraph graph = roomGraph();
  const auto messages = test::throughBytes(updateMessages(graph, outputOf({{4}, {1}}), 7, kTime, false));
  ASSERT_EQ(messages.size(), 1u);
  const graph_update_t& m = messages[0];
  EXPECT_EQ(m.round, 7);
  EXPECT_EQ(m.complete, 0);
  EXPECT_EQ(m.num_chunks, 1);
  EXPECT_EQ(m.keyframe, 13);
  ASSERT_EQ(m.num_nodes, 2);
  EXPECT_EQ(m.nodes[0].id, 2);
  ASSERT_EQ(m.num_planes, 2);
  EXPECT_EQ(m.planes[0].id, 1);  // by id
  EXPECT_EQ(m.planes[1].id, 4);
}

TEST(GraphMessagesTest, APlaneArrivesAsItIsInTheGraph) {
  const SituationalGraph graph = roomGraph();
  const auto messages = test::throughBytes(updateMessages(graph, outputOf({{3}}), 0, kTime, false));
  const auto read = fromMessage(messages.at(0).planes.at(0));
  ASSERT_TRUE(read);
  const PlaneNode& plane = graph.planes.at({3});
  EXPECT_EQ(read->id, plane.id);
  EXPECT_FALSE(read->merged_into.valid());
  EXPECT_EQ(read->floor, plane.floor);
  EXPECT_EQ(read->label, PlaneLabel::kY);
  EXPECT_EQ(read->normal_map, plane.normal_map);
  EXPECT_EQ(read->d, plane.d());
  EXPECT_EQ(read->centroid_map, plane.centroid_map);
  EXPECT_EQ(read->covariance, plane.covariance);
  ASSERT_EQ(read->polygon_map.size(), 4u);
  EXPECT_EQ(read->polygon_map[2], plane.polygon_map[2].cast<float>());
}

TEST(GraphMessagesTest, AMergedPlaneNamesTheOneThatStandsAtTheEndOfItsMerges) {
  SituationalGraph graph = roomGraph();
  graph.planes.erase({5});
  graph.planes.erase({4});
  graph.merged_planes = {{{5}, {4}}, {{4}, {2}}};
  const auto messages = test::throughBytes(updateMessages(graph, outputOf({{5}, {2}}), 0, kTime, false));
  ASSERT_EQ(messages.at(0).num_planes, 2);
  const auto merged = fromMessage(messages[0].planes[1]);
  ASSERT_TRUE(merged);
  EXPECT_EQ(merged->id, PlaneId{5});
  EXPECT_EQ(merged->merged_into, PlaneId{2});
}

TEST(GraphMessagesTest, APlaneThatIsNowhereIsAnError) {
  const SituationalGraph graph = roomGraph();
  EXPECT_THROW(updateMessages(graph, outputOf({{77}}), 0, kTime, false), std::logic_error);
  SituationalGraph circle = roomGraph();
  circle.merged_planes = {{{8}, {9}}, {{9}, {8}}};
  EXPECT_THROW(updateMessages(circle, outputOf({{8}}), 0, kTime, false), std::logic_error);
}

TEST(GraphMessagesTest, ASnapshotHoldsEveryNodeOnceInDatagrams) {
  SituationalGraph graph = largeGraph(400, 48);
  graph.merged_planes = {{{50}, {1}}};
  const auto messages = test::throughBytes(snapshotMessages(graph, outputOf({}), 9, kTime));
  ASSERT_GT(messages.size(), 4u);
  std::vector<int64_t> keyframes, planes;
  int floors = 0;
  for (size_t i = 0; i < messages.size(); ++i) {
    const graph_update_t& m = messages[i];
    EXPECT_LE(m.getEncodedSize(), kMaxRecordsBytes);
    EXPECT_EQ(m.complete, 1);
    EXPECT_EQ(m.chunk, static_cast<int32_t>(i));
    EXPECT_EQ(m.num_chunks, static_cast<int32_t>(messages.size()));
    EXPECT_EQ(m.graph_digest, std::string(64, 'a'));
    for (const graph_node_t& node : m.nodes) {
      if (node.layer == graph_node_t::KEYFRAMES) keyframes.push_back(node.id);
      floors += node.layer == graph_node_t::FLOORS;
    }
    for (const graph_plane_t& plane : m.planes) planes.push_back(plane.id);
  }
  EXPECT_EQ(keyframes.size(), graph.keyframes.size());
  EXPECT_EQ(floors, 1);
  EXPECT_EQ(planes.size(), graph.planes.size() + 1);
  EXPECT_TRUE(std::is_sorted(planes.begin(), planes.end()));
}

TEST(GraphMessagesTest, TheLargestPlaneStillFitsADatagram) {
  const SituationalGraph graph = largeGraph(3, kMaxMapPlaneCorners);
  for (const graph_update_t& m : snapshotMessages(graph, outputOf({}), 0, kTime))
    EXPECT_LE(m.getEncodedSize(), kMaxRecordsBytes);
  EXPECT_THROW(snapshotMessages(largeGraph(1, kMaxMapPlaneCorners + 1), outputOf({}), 0, kTime),
               std::logic_error);
}

TEST(GraphMessagesTest, AnEmptyRoundIsOneEmptyMessage) {
  const auto messages = updateMessages(SituationalGraph{}, RoundOutput{}, 0, kTime, false);
  ASSERT_EQ(messages.size(), 1u);
  EXPECT_EQ(messages[0].keyframe, -1);
  EXPECT_EQ(messages[0].num_nodes, 0);
  EXPECT_EQ(messages[0].num_planes, 0);
}

}  // namespace
}  // namespace sgraphs
