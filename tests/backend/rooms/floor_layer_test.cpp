// Storeys of the graph.
#include <gtest/gtest.h>

#include "backend/rooms/floor_walls.h"
#include "tests/backend/rooms/room_world.h"

namespace sgraphs {
namespace {

using testing_support::boxRoom;
using testing_support::makeRoomWorld;
using testing_support::RoomRun;
using testing_support::RoomWorld;
using testing_support::seenRooms;

RoomWorld twoStoreys(bool noise) {
  return makeRoomWorld({boxRoom(-2, -3, 5, 6), boxRoom(3.2, -3, 4, 6), boxRoom(-2, -3, 5, 6, 1, 3.0)},
                       {{0, 8}, {1, 8}, {2, 10}}, {.noise = noise});
}

TEST(FloorLayerTest, KeyframesAndTheirPlanesAreOnTheirStorey) {
  const RoomWorld world = twoStoreys(false);
  RoomRun run;
  run.all(world, true);
  const SituationalGraph& graph = run.graph();
  ASSERT_EQ(graph.floors.size(), 2u);
  int64_t upper = 0;
  for (const auto& [id, node] : graph.keyframes) {
    EXPECT_EQ(node.floor, FloorId{id.value < 16 ? 0 : 1});
    upper += node.floor == FloorId{1};
  }
  EXPECT_EQ(upper, 10);
  // The walls of the upper room stand on those of the lower: they are others all the same.
  size_t planes = 0;
  for (const auto& [id, plane] : graph.planes) planes += plane.floor == FloorId{1};
  EXPECT_EQ(planes, 5u);
}

TEST(FloorLayerTest, AStoreyHasItsHeightAndItsCentre) {
  const RoomWorld world = twoStoreys(false);
  RoomRun run;
  run.all(world, true);
  const auto& floors = run.graph().floors;
  EXPECT_NEAR(floors.at(FloorId{0}).z_m, -0.6, 1e-3);
  EXPECT_NEAR(floors.at(FloorId{1}).z_m, 2.4, 1e-3);
  EXPECT_TRUE(floors.at(FloorId{1}).has_height);
  const auto inMap = [&](const Eigen::Vector3d& p) -> Eigen::Vector2d {
    return (world.truth[0].inverse() * p).head<2>();
  };
  EXPECT_LT((floors.at(FloorId{0}).center_map - inMap({2.6, 0, 0})).norm(), 1e-3);
  EXPECT_LT((floors.at(FloorId{1}).center_map - inMap({0.5, 0, 3})).norm(), 1e-3);
  EXPECT_EQ(run.count("floor_wall"), 4);
  EXPECT_EQ(run.count("floor_height"), 2);
  EXPECT_EQ(run.count("floor_room"), 3);
}

// Mistake 8 of earlier systems: work on an upper storey does not tear it from the lower one.
TEST(FloorLayerTest, AnUpperStoreyIsNotTorn) {
  const RoomWorld world = twoStoreys(true);
  RoomRun with, without;
  with.all(world, true);
  without.all(world, false);
  const auto step = [](const SituationalGraph& graph) {
    return graph.keyframes.at(KeyframeId{15}).T_map_body.inverse() *
           graph.keyframes.at(KeyframeId{16}).T_map_body;
  };
  const SE3 measured = world.keyframes[16].relative_poses[0].T_from_to;
  EXPECT_LT((step(with.graph()).inverse() * measured).translation.norm(), 0.02);
  EXPECT_LT((step(with.graph()).inverse() * step(without.graph())).translation.norm(), 0.01);
}

// The same with a correction of half a metre up there: what is below stays, and the way up keeps its length.
TEST(FloorLayerTest, ALoopOnAnUpperStoreyDoesNotTearItFromTheLower) {
  const RoomWorld world =
      makeRoomWorld({boxRoom(-2, -3, 5, 6), boxRoom(3.2, -3, 4, 6), boxRoom(-2, -3, 5, 6, 1, 3.0),
                     boxRoom(3.2, -3, 4, 6, 1, 3.0)},
                    {{0, 8}, {1, 8}, {2, 8}, {3, 8}, {2, 8}}, {.drift_m = 0.22, .odometry_sigma_m = 0.025});
  RoomRun run;
  run.all(world, true);
  const auto between = [&](size_t from, size_t to) {
    return run.graph().keyframes.at(KeyframeId{static_cast<int64_t>(from)}).T_map_body.inverse() *
           run.graph().keyframes.at(KeyframeId{static_cast<int64_t>(to)}).T_map_body;
  };
  const SE3 lower = between(0, 15), way_up = between(15, 16);
  const SE3 truth = world.truth[16].inverse() * world.truth[39];
  ASSERT_GT((between(16, 39).inverse() * truth).translation.norm(), 0.3);
  LoopClosure loop;
  loop.id = LoopId{0};
  loop.pose.kind = RelativePoseKind::kLoop;
  loop.pose.from = KeyframeId{16};
  loop.pose.to = KeyframeId{39};
  loop.pose.T_from_to = truth;
  loop.pose.covariance = 1e-4 * Matrix6d::Identity();
  LoopClosures loops;
  loops.accepted = {loop};
  run.newest = run.backend.step({.round = run.round++, .time = Time{}, .keyframe = {}, .loops = loops});
  for (const std::string& line : run.newest.refused) ADD_FAILURE() << line;
  for (int i = 0; i < 3; ++i) run.idle(seenRooms(world, run.graph(), run.round - 1));
  run.graph().check();
  EXPECT_EQ(run.count("loop"), 1);
  EXPECT_LT((between(16, 39).inverse() * truth).translation.norm(), 0.1);
  EXPECT_LT((between(15, 16).inverse() * way_up).translation.norm(), 0.02);
  EXPECT_LT((between(0, 15).inverse() * lower).translation.norm(), 0.02);
  for (const auto& [id, node] : run.graph().keyframes)
    EXPECT_EQ(node.floor, FloorId{id.value < 16 ? 0 : 1}) << id.str();
}

TEST(FloorLayerTest, AStoreyWithoutHeightHasNone) {
  const RoomWorld world = twoStoreys(false);
  RoomRun run;
  for (size_t k = 0; k < 26; ++k) {
    std::optional<Rooms> rooms;
    if (k > 0) {
      rooms = seenRooms(world, run.graph(), run.round - 1);
      for (FloorObservation& floor : rooms->floors)
        if (floor.id == FloorId{1}) floor.has_height = false;
    }
    run.step(world, k, rooms);
  }
  EXPECT_FALSE(run.graph().floors.at(FloorId{1}).has_height);
  EXPECT_EQ(run.count("floor_height"), 1);
  run.idle(seenRooms(world, run.graph(), run.round - 1));
  EXPECT_TRUE(run.graph().floors.at(FloorId{1}).has_height);
  EXPECT_NEAR(run.graph().floors.at(FloorId{1}).z_m, 2.4, 1e-3);
}

// Stairs: keyframes between storeys are on none.
TEST(FloorLayerTest, KeyframesBetweenStoreysAreOnNone) {
  const RoomWorld world = twoStoreys(false);
  RoomRun run;
  for (size_t k = 0; k < 6; ++k) run.step(world, k);
  Rooms rooms = seenRooms(world, run.graph(), run.round - 1);
  rooms.keyframe_floors = {{KeyframeId{5}, FloorId{}}};
  run.step(world, 6, rooms);
  EXPECT_FALSE(run.graph().keyframes.at(KeyframeId{5}).floor.valid());
  EXPECT_NE(std::find(run.newest.changed.begin(), run.newest.changed.end(), KeyframeId{5}),
            run.newest.changed.end());
  run.graph().check();
}

TEST(FloorLayerTest, AStoreyNobodyIsOnIsWithdrawn) {
  const RoomWorld world = twoStoreys(false);
  RoomRun run;
  run.all(world, true);
  Rooms rooms = seenRooms(world, run.graph(), run.round - 1);
  rooms.floors.push_back({.id = FloorId{5}, .has_height = true, .z_m = 9, .center_map = {1, 1}});
  run.idle(rooms);
  EXPECT_TRUE(run.graph().floors.contains(FloorId{5}));
  EXPECT_TRUE(run.newest.changed_rooms);
  rooms.floors.pop_back();
  run.idle(rooms);
  EXPECT_FALSE(run.graph().floors.contains(FloorId{5}));
}

}  // namespace
}  // namespace sgraphs
