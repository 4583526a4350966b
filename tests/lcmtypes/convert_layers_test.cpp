#include "lcmtypes/convert/convert_layers.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "lcmtypes/convert/chunks.h"
#include "lcmtypes/convert/convert.h"
#include "tests/lcmtypes/through_bytes.h"

namespace sgraphs {
namespace {

FreeSpaceVertex vertexAt(int64_t id, float x, std::vector<VertexId> neighbours) {
  return {VertexId{id}, FloorId{0}, ClusterId{2}, {x, 1, 0.1f}, 0.8f, std::move(neighbours)};
}

FreeSpace someFreeSpace() {
  FreeSpace space;
  space.round = 4;
  space.time = Time{1'700'000'000'000'000};
  space.vertices = {{{0}, vertexAt(0, 0, {{1}})}, {{1}, vertexAt(1, 1, {{0}})}};
  FreeSpaceCluster cluster;
  cluster.id = {2};
  cluster.floor = {0};
  cluster.is_corridor = true;
  cluster.area_m2 = 12.5f;
  cluster.max_clearance_m = 1.25f;
  cluster.center_map = {0.5f, 1};
  cluster.border = {
      {{0, 0}, BorderKind::kObstacle}, {{2, 0}, BorderKind::kPassage}, {{2, 3}, BorderKind::kFrontier}};
  space.clusters = {{{2}, cluster}};
  space.passages = {{{0}, {{0}, {0}, {2}, {3}, {2, 0}, {2, 0.9f}, 0.05f, true}}};
  return space;
}

bool operator==(const FreeSpaceVertex& a, const FreeSpaceVertex& b) {
  return a.id == b.id && a.floor == b.floor && a.cluster == b.cluster && a.position_map == b.position_map &&
         a.clearance_m == b.clearance_m && a.neighbours == b.neighbours;
}

TEST(ConvertFreeSpaceTest, AReaderFollowsRoundByRound) {
  const FreeSpace first = someFreeSpace();
  FreeSpace second = first, reader;
  second.round = 5;
  second.vertices.erase(VertexId{0});
  second.vertices.at({1}).neighbours.clear();
  second.vertices[{7}] = vertexAt(7, 3, {});
  second.clusters.at({2}).area_m2 = 13;
  second.passages.clear();
  ASSERT_TRUE(applyMessages(test::throughBytes(toMessages({}, first, "")), reader));
  EXPECT_EQ(reader.round, 4);
  const auto delta = test::throughBytes(toMessages(first, second, "because"));
  EXPECT_EQ(delta.at(0).num_vertices, 2) << "what did not change is not sent";
  EXPECT_EQ(delta.at(0).why_not, "because");
  ASSERT_TRUE(applyMessages(delta, reader));
  EXPECT_EQ(reader.round, 5);
  ASSERT_EQ(reader.vertices.size(), 2u);
  for (const auto& [id, vertex] : second.vertices) EXPECT_TRUE(reader.vertices.at(id) == vertex) << id.value;
  EXPECT_TRUE(reader.passages.empty());
  const FreeSpaceCluster& cluster = reader.clusters.at({2});
  EXPECT_EQ(cluster.area_m2, 13);
  EXPECT_TRUE(cluster.is_corridor);
  ASSERT_EQ(cluster.border.size(), 3u);
  EXPECT_EQ(cluster.border[1].kind, BorderKind::kPassage);
  EXPECT_EQ(cluster.border[2].position_map, Eigen::Vector2f(2, 3));
}

TEST(ConvertFreeSpaceTest, ALargeOneIsCutIntoDatagrams) {
  FreeSpace space;
  space.round = 0;
  for (int64_t i = 0; i < 5000; ++i) space.vertices[{i}] = vertexAt(i, static_cast<float>(i), {{i + 1}});
  const auto chunks = test::throughBytes(toMessages({}, space, ""));
  ASSERT_GT(chunks.size(), 3u);
  for (const free_space_t& m : chunks) EXPECT_LE(m.getEncodedSize(), kMaxRecordsBytes);
  FreeSpace reader;
  ASSERT_TRUE(applyMessages(chunks, reader));
  EXPECT_EQ(reader.vertices.size(), 5000u);
}

TEST(ConvertFreeSpaceTest, WhatCannotBeChangesNothing) {
  const std::vector<free_space_t> good = toMessages({}, someFreeSpace(), "");
  const std::vector<std::function<void(free_space_t&)>> faults = {
      [](free_space_t& m) { m.round = -1; },
      [](free_space_t& m) { m.vertices[0].position[1] = NAN; },
      [](free_space_t& m) { m.vertices[0].clearance_m = -1; },
      [](free_space_t& m) {
        m.vertices[0].neighbours = {3, 3};
      },
      [](free_space_t& m) { m.clusters[0].kind[0] = 9; },
      [](free_space_t& m) { m.clusters[0].area_m2 = NAN; },
      [](free_space_t& m) { m.passages[0].cluster_b = -1; },
      [](free_space_t& m) { m.passages[0].left[0] = INFINITY; }};
  for (size_t i = 0; i < faults.size(); ++i) {
    std::vector<free_space_t> bad = good;
    faults[i](bad.at(0));
    FreeSpace reader;
    EXPECT_FALSE(applyMessages(bad, reader)) << "fault " << i;
    EXPECT_TRUE(reader.vertices.empty()) << "fault " << i;
  }
}

Rooms someRooms() {
  RoomObservation room;
  room.id = {3};
  room.kind = RoomKind::kFinite;
  room.floor = {1};
  room.accepted = Time{123};
  room.polygon = {{{0, 0}, {4}}, {{5, 0}, {5}}, {{5, 3}, {}}, {{0, 3}, {7}}};
  room.center_map = {2.5, 1.5};
  room.area_m2 = 15;
  room.pairs = {{{4}, {6}}, {{5}, {7}}};
  room.free_center_map = {2.4, 1.6};
  room.anchor = {12};
  return {.round = 2,
          .time = Time{99},
          .rooms = {room},
          .doorways = {{{0}, {1}, {3}, {}, {5, 1, 0.1}, 0.9}},
          .floors = {{{0}, true, -0.4, {1, 2}}, {{1}, false, 0, {3, 4}}},
          .keyframe_floors = {{{12}, {1}}, {{13}, {}}}};
}

TEST(ConvertRoomsTest, RoundTripIsExact) {
  const Rooms rooms = someRooms();
  const auto read = fromMessages(test::throughBytes(toMessages(rooms, "")));
  ASSERT_TRUE(read);
  EXPECT_EQ(read->round, 2);
  ASSERT_EQ(read->rooms.size(), 1u);
  const RoomObservation &a = rooms.rooms[0], &b = read->rooms[0];
  EXPECT_EQ(b.id, a.id);
  EXPECT_EQ(b.kind, a.kind);
  EXPECT_EQ(b.floor, a.floor);
  EXPECT_EQ(b.accepted, a.accepted);
  EXPECT_EQ(b.center_map, a.center_map);
  EXPECT_EQ(b.area_m2, a.area_m2);
  EXPECT_EQ(b.pairs, a.pairs);
  EXPECT_EQ(b.free_center_map, a.free_center_map);
  EXPECT_EQ(b.anchor, a.anchor);
  ASSERT_EQ(b.polygon.size(), 4u);
  EXPECT_EQ(b.polygon[1].position_map, Eigen::Vector2d(5, 0));
  EXPECT_EQ(b.polygon[2].wall, PlaneId{});
  EXPECT_EQ(b.walls(), (std::vector<PlaneId>{{4}, {5}, {6}, {7}}));
  EXPECT_EQ(read->doorways.at(0).b, RoomId{});
  EXPECT_EQ(read->doorways.at(0).position_map, Eigen::Vector3d(5, 1, 0.1));
  EXPECT_EQ(read->floors.at(0).z_m, -0.4);
  EXPECT_FALSE(read->floors.at(1).has_height);
  EXPECT_EQ(read->keyframe_floors.at(1).floor, FloorId{});
}

TEST(ConvertRoomsTest, WhatCannotBeIsRefused) {
  const rooms_t good = toMessages(someRooms(), "").at(0);
  const std::vector<std::function<void(rooms_t&)>> faults = {
      [](rooms_t& m) { m.round = -1; },
      [](rooms_t& m) { m.rooms[0].kind = 0; },
      [](rooms_t& m) { m.rooms[0].polygon[1][0] = NAN; },
      [](rooms_t& m) { m.rooms[0].polygon.resize(2); },
      [](rooms_t& m) { m.rooms[0].area_m2 = 0; },
      [](rooms_t& m) { m.rooms[0].pairs[0][1] = m.rooms[0].pairs[0][0]; },
      [](rooms_t& m) { m.rooms.push_back(m.rooms[0]); },
      [](rooms_t& m) { m.doorways[0].width_m = 0; },
      [](rooms_t& m) { m.doorways[0].room_b = m.doorways[0].room_a; },
      [](rooms_t& m) { m.floors[0].z_m = NAN; },
      [](rooms_t& m) { m.keyframe[0] = -1; }};
  for (size_t i = 0; i < faults.size(); ++i) {
    std::vector<rooms_t> bad = {good};
    faults[i](bad[0]);
    EXPECT_FALSE(fromMessages(bad)) << "fault " << i;
  }
}

LoopClosures someLoops() {
  LoopClosure loop;
  loop.id = {2};
  loop.pose.kind = RelativePoseKind::kLoop;
  loop.pose.from = {3};
  loop.pose.to = {70};
  loop.pose.T_from_to.translation = {1, -2, 0.1};
  loop.pose.covariance = 1e-4 * Matrix6d::Identity();
  loop.pose.registered = true;
  loop.overlap = 0.75;
  loop.inlier_share = 0.5;
  LoopClosure next = loop;
  next.id = {5};
  return {
      .round = 71, .time = Time{99}, .accepted = {loop, next}, .withdrawn = {{0}, {1}}, .searching = true};
}

TEST(ConvertLoopsTest, RoundTripIsExact) {
  const LoopClosures loops = someLoops();
  const auto read = fromMessages(test::throughBytes(toMessages(loops, "")));
  ASSERT_TRUE(read);
  EXPECT_EQ(read->round, 71);
  EXPECT_TRUE(read->searching);
  EXPECT_EQ(read->withdrawn, (std::vector<LoopId>{{0}, {1}}));
  ASSERT_EQ(read->accepted.size(), 2u);
  const LoopClosure &a = loops.accepted[0], &b = read->accepted[0];
  EXPECT_EQ(b.id, a.id);
  EXPECT_EQ(b.pose.from, a.pose.from);
  EXPECT_EQ(b.pose.to, a.pose.to);
  EXPECT_EQ(b.pose.T_from_to.translation, a.pose.T_from_to.translation);
  EXPECT_EQ(b.pose.covariance, a.pose.covariance);
  EXPECT_EQ(b.overlap, 0.75);
  EXPECT_EQ(b.inlier_share, 0.5);
}

TEST(ConvertLoopsTest, WhatCannotBeIsRefused) {
  const loop_closures_t good = toMessages(someLoops(), "").at(0);
  const std::vector<std::function<void(loop_closures_t&)>> faults = {
      [](loop_closures_t& m) { m.round = -1; },
      [](loop_closures_t& m) { m.accepted[0].id = -1; },
      [](loop_closures_t& m) { m.accepted[1].id = m.accepted[0].id; },
      [](loop_closures_t& m) { m.accepted[0].pose.kind = relative_pose_t::NEIGHBOUR; },
      [](loop_closures_t& m) { m.accepted[0].pose.from_keyframe = m.accepted[0].pose.to_keyframe; },
      [](loop_closures_t& m) { m.accepted[0].pose.covariance[0] = -1; },
      [](loop_closures_t& m) { m.accepted[0].overlap = NAN; },
      [](loop_closures_t& m) { m.accepted[0].inlier_share = 1.5; },
      [](loop_closures_t& m) { m.withdrawn[1] = m.withdrawn[0]; }};
  for (size_t i = 0; i < faults.size(); ++i) {
    std::vector<loop_closures_t> bad = {good};
    faults[i](bad[0]);
    EXPECT_FALSE(fromMessages(bad)) << "fault " << i;
  }
}

TEST(RoundAssemblyTest, ChunksOfANewerRoundReplaceAnIncompleteOne) {
  RoundAssembly<rooms_t> assembly;
  rooms_t m{};
  bool refused = false;
  m.round = 1;
  m.num_chunks = 2;
  EXPECT_FALSE(assembly.add(m, refused));
  EXPECT_FALSE(refused);
  m.round = 2;
  m.chunk = 1;
  EXPECT_FALSE(assembly.add(m, refused));
  m.chunk = 0;
  const auto all = assembly.add(m, refused);
  ASSERT_TRUE(all);
  EXPECT_EQ(all->at(0).chunk, 0);
  EXPECT_EQ(all->at(1).chunk, 1);
  EXPECT_FALSE(assembly.add(m, refused));
  EXPECT_TRUE(refused) << "a repetition";
  m.round = 3;
  m.num_chunks = 0;
  assembly.add(m, refused);
  EXPECT_TRUE(refused);
}

TEST(ConvertMapUpdateTest, KeyframesAndPlanesOfAllChunksAreReadAndOtherLayersPassedOver) {
  graph_update_t m{};
  m.round = 6;
  m.keyframe = 9;
  m.idle = 1;
  m.keyframe_covariance[7] = 0.25;
  graph_node_t node{};
  node.layer = graph_node_t::KEYFRAMES;
  node.id = 9;
  node.floor = -1;
  node.T_map_node.xyz[0] = 2;
  node.T_map_node.wxyz[0] = 1;
  m.nodes.push_back(node);
  node.layer = graph_node_t::ROOMS;
  m.nodes.push_back(node);
  m.num_nodes = 2;
  const auto update = fromMessages(test::throughBytes(std::vector{m}));
  ASSERT_TRUE(update);
  EXPECT_EQ(update->round, 6);
  EXPECT_TRUE(update->idle);
  EXPECT_EQ(update->newest, KeyframeId{9});
  EXPECT_EQ(update->newest_covariance(1, 1), 0.25);
  ASSERT_EQ(update->keyframes.size(), 1u);
  EXPECT_FALSE(update->keyframes[0].floor.valid());
  EXPECT_EQ(update->keyframes[0].T_map_body.translation.x(), 2);
  m.nodes[0].T_map_node.wxyz[0] = 2;
  EXPECT_FALSE(fromMessages(std::vector{m})) << "no unit quaternion";
}

TEST(ConvertMapChunkTest, EveryPlaceOfTheCloudIsThereOnceWithinTheVoxelAndDatagramsStaySmall) {
  Keyframe keyframe;
  keyframe.id = {5};
  for (int row = 0; row < 100; ++row)
    for (int column = 0; column < 1000; ++column)
      keyframe.points.push_back(
          {{0.02F * static_cast<float>(column), 0.3F * static_cast<float>(row), 1}, 0, 1});
  size_t points = 0;
  const auto chunks = test::throughBytes(mapChunks(keyframe));
  EXPECT_EQ(chunks.size(), 3u) << "20,000 voxels, 8,000 points a message";
  for (const map_chunk_t& m : chunks) {
    EXPECT_LE(m.getEncodedSize(), kMaxRecordsBytes);
    EXPECT_EQ(m.keyframe, 5);
    const auto read = pointsOf(m);
    ASSERT_TRUE(read);
    points += read->size();
    for (const Eigen::Vector3f& p : *read) {
      ASSERT_NEAR(p.z(), 1, 1e-3);
      const float nearest = 0.02F * std::round(p.x() / 0.02F);
      ASSERT_NEAR(p.x(), nearest, 1.1e-3) << "points as they were, not averaged";
    }
  }
  EXPECT_NEAR(static_cast<double>(points), 20000, 300);
  map_chunk_t bad = chunks[0];
  bad.num_points = 1;
  EXPECT_FALSE(pointsOf(bad));
}

}  // namespace
}  // namespace sgraphs
