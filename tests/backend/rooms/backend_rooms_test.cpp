// The backend with rooms, on rooms with exact truth.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "tests/backend/rooms/room_world.h"

namespace sgraphs {
namespace {

using testing_support::boxRoom;
using testing_support::makeRoomWorld;
using testing_support::RoomRun;
using testing_support::RoomWorld;
using testing_support::RoomWorldOptions;
using testing_support::seenRoom;
using testing_support::seenRooms;
using testing_support::WorldRoom;

RoomWorld twoRooms(const RoomWorldOptions& options = {}) {
  return makeRoomWorld({boxRoom(-2, -3, 5, 6), boxRoom(3.2, -3, 4, 6.3)}, {{0, 8}, {1, 8}}, options);
}

struct Distance {
  double m = 0, rad = 0;  // of the worst keyframe
};

Distance between(const SituationalGraph& a, const SituationalGraph& b) {
  Distance distance;
  for (const auto& [id, node] : a.keyframes) {
    const SE3 error = node.T_map_body.inverse() * b.keyframes.at(id).T_map_body;
    distance.m = std::max(distance.m, error.translation.norm());
    distance.rad = std::max(distance.rad, so3Log(error.rotation).norm());
  }
  return distance;
}

Distance fromTruth(const SituationalGraph& graph, const RoomWorld& world) {
  Distance distance;
  const SE3 T_map_world = world.truth[0].inverse();
  for (const auto& [id, node] : graph.keyframes) {
    const SE3 error = node.T_map_body.inverse() * T_map_world * world.truth[static_cast<size_t>(id.value)];
    distance.m = std::max(distance.m, error.translation.norm());
    distance.rad = std::max(distance.rad, so3Log(error.rotation).norm());
  }
  return distance;
}

TEST(BackendRoomsTest, APerfectGraphIsLeftAloneAndItsCentresAreTrue) {
  for (const double heading : {0.0, 0.5, M_PI / 4}) {
    const RoomWorld world = twoRooms({.start_heading_rad = heading});
    RoomRun run;
    run.all(world, true);
    const Distance off = fromTruth(run.graph(), world);
    EXPECT_LT(off.m, 1e-4);
    EXPECT_LT(off.rad, 1e-5);
    ASSERT_EQ(run.graph().rooms.size(), 2u);
    for (size_t r = 0; r < 2; ++r) {
      const Eigen::Vector2d mid = polygonCentroid(world.rooms[r].corners);
      const Eigen::Vector3d truth = world.truth[0].inverse() * Eigen::Vector3d(mid.x(), mid.y(), 0);
      EXPECT_LT((run.graph().rooms.at(RoomId{static_cast<int64_t>(r)}).center_map - truth.head<2>()).norm(),
                1e-4);
    }
  }
}

TEST(BackendRoomsTest, EveryKindOfFactorReachesTheSolver) {
  const RoomWorld world = twoRooms({.noise = true});
  RoomRun run;
  run.all(world, true);
  EXPECT_EQ(run.count("room_wall"), 4);
  EXPECT_EQ(run.count("room_wall_infinite"), 0);
  EXPECT_EQ(run.count("room_shape"), 12);
  EXPECT_EQ(run.count("floor_wall"), 2);
  EXPECT_EQ(run.count("floor_height"), 1);
  EXPECT_EQ(run.count("floor_room"), 2);
  const auto statistics = run.backend.factorStatistics();
  EXPECT_GT(statistics.at("room_shape").chi2, 0.0);
  EXPECT_LT(statistics.at("room_shape").chi2, 12.0);
  // Centres take up what their walls disagree in.
  for (const char* kind : {"room_wall", "floor_wall", "floor_height", "floor_room"})
    EXPECT_LT(statistics.at(kind).chi2, 1e-3) << kind;
}

// The paper's factors of centres pull at nothing: without the shape, a graph with rooms is the same.
TEST(BackendRoomsTest, CentresPullAtNothing) {
  const RoomWorld world = twoRooms({.noise = true});
  BackendConfig shapeless;
  shapeless.rooms.shape_sigma_rad = 0.1;  // twelve relations, next to nothing
  RoomRun with(shapeless), without;
  with.all(world, true);
  without.all(world, false);
  EXPECT_EQ(with.count("room_wall"), 4);
  const Distance apart = between(with.graph(), without.graph());
  EXPECT_LT(apart.m, 2e-4);
  EXPECT_LT(apart.rad, 2e-5);
}

// A wall seen twice, each time 12 mrad askew at a sigma of 10 mrad.
TEST(BackendRoomsTest, AWallHardlySeenIsPulledSquare) {
  RoomWorld world = makeRoomWorld({boxRoom(-2, -3, 5, 6)}, {{0, 10}});
  const double askew = 0.012;
  for (size_t k = 0; k < world.planes.size(); ++k) {
    auto& planes = world.planes[k].planes;
    if (k < 2 || k > 3) {
      planes.erase(planes.begin() + 1);
      continue;
    }
    planes[1].normal_body = so3Exp({0, 0, askew}) * planes[1].normal_body;
    planes[1].covariance = testing_support::observationCovariance(0.01, 0.004);
  }
  const Eigen::Vector3d normal_map = world.truth[0].rotation.conjugate() * Eigen::Vector3d(-1, 0, 0);
  const auto askewNow = [&](const SituationalGraph& graph) {
    double best = 1;
    for (const auto& [id, plane] : graph.planes)
      best = std::min(best, std::abs(plane.normal_map.cross(normal_map).z()) +
                                (plane.normal_map.dot(normal_map) < 0.9 ? 1.0 : 0.0));
    return best;
  };
  RoomRun with, without;
  with.all(world, true);
  without.all(world, false);
  EXPECT_GT(askewNow(without.graph()), 0.008);
  EXPECT_LT(askewNow(with.graph()), 0.005);
  EXPECT_LT(fromTruth(with.graph(), world).m, fromTruth(without.graph(), world).m + 1e-3);
}

// What is seen not to be square stays as it is seen: a trapezoid, and a wall one degree off.
TEST(BackendRoomsTest, RoomsThatAreNotSquareAreNotHurt) {
  for (const double slant : {M_PI / 180, 12 * M_PI / 180}) {
    const WorldRoom room{{{-3, -2}, {3, -2}, {3, 2 + 6 * std::tan(slant)}, {-3, 2}}, 0, 0};
    for (const uint32_t seed : {1U, 2U, 3U}) {
      const RoomWorld world = makeRoomWorld({room}, {{0, 16}}, {.noise = true, .seed = seed});
      RoomRun with, without;
      with.all(world, true);
      without.all(world, false);
      ASSERT_EQ(with.graph().rooms.size(), 1u);
      for (const auto& [id, plane] : with.graph().planes)
        EXPECT_LT((plane.normal_map - without.graph().planes.at(id).normal_map).norm(), 0.0015) << slant;
      EXPECT_LT(fromTruth(with.graph(), world).m, fromTruth(without.graph(), world).m + 1e-3) << slant;
    }
  }
}

// Mistake 1 of earlier systems.
TEST(BackendRoomsTest, AnUpgradedRoomGetsItsFourWalls) {
  const RoomWorld world = makeRoomWorld({boxRoom(-4, -1, 8, 2)}, {{0, 10}});
  RoomRun run;
  const auto seenAs = [&](RoomKind kind) {
    Rooms rooms = seenRooms(world, run.graph(), run.round - 1);
    rooms.rooms = {seenRoom(world, 0, run.graph(), RoomId{0}, kind, KeyframeId{0})};
    return rooms;
  };
  for (size_t k = 0; k < 5; ++k) run.step(world, k);
  run.step(world, 5, seenAs(RoomKind::kInfinite));
  EXPECT_TRUE(run.newest.changed_rooms);
  EXPECT_EQ(run.count("room_wall"), 0);
  EXPECT_EQ(run.count("room_wall_infinite"), 2);  // the pair, and the place along it
  const Eigen::Vector2d before = run.graph().rooms.at(RoomId{0}).center_map;
  run.step(world, 6, seenAs(RoomKind::kFinite));
  EXPECT_EQ(run.count("room_wall"), 2);
  EXPECT_EQ(run.count("room_wall_infinite"), 0);
  EXPECT_LT((run.graph().rooms.at(RoomId{0}).center_map - before).norm(), 0.05);
  run.step(world, 7, seenAs(RoomKind::kFinite));
  EXPECT_EQ(run.count("room_wall"), 2);
  run.graph().check();
}

TEST(BackendRoomsTest, AWithdrawnRoomLeavesNothing) {
  const RoomWorld world = twoRooms();
  RoomRun run;
  run.all(world, true);
  Rooms rooms = seenRooms(world, run.graph(), run.round - 1);
  rooms.doorways = {{PassageId{4}, FloorId{0}, RoomId{0}, RoomId{1}, {1, 0, 0}, 0.9}};
  run.idle(rooms);
  ASSERT_EQ(run.graph().doorways.size(), 1u);
  EXPECT_TRUE(run.newest.changed_rooms);
  rooms.rooms.erase(rooms.rooms.begin());
  run.idle(rooms);
  EXPECT_TRUE(run.newest.changed_rooms);
  EXPECT_EQ(run.graph().rooms.size(), 1u);
  EXPECT_EQ(run.count("room_wall"), 2);
  EXPECT_EQ(run.count("room_shape"), 6);
  EXPECT_EQ(run.count("floor_room"), 1);
  const Doorway& doorway = run.graph().doorways.at(PassageId{4});
  EXPECT_EQ(doorway.a, RoomId{1});
  EXPECT_FALSE(doorway.b.valid());
  rooms.rooms.clear();
  run.idle(rooms);
  for (const char* kind : {"room_wall", "room_wall_infinite", "room_shape", "floor_room"})
    EXPECT_EQ(run.count(kind), 0) << kind;
  EXPECT_TRUE(run.graph().doorways.empty());
  run.graph().check();
}

// Mistakes 2 and 10 of earlier systems: nothing piles up, and what only repeats costs no solve of the whole.
TEST(BackendRoomsTest, RepeatedMessagesChangeNothing) {
  const RoomWorld world = twoRooms({.noise = true});
  RoomRun run;
  run.all(world, true);
  run.idle(seenRooms(world, run.graph(), run.round - 1));
  const auto before = run.backend.factorStatistics();
  const std::string digest = run.newest.graph_digest;
  for (int i = 0; i < 200; ++i) {
    run.idle(seenRooms(world, run.graph(), run.round - 1));
    EXPECT_FALSE(run.newest.whole_graph);
    EXPECT_FALSE(run.newest.changed_rooms);
  }
  for (const auto& [kind, statistics] : run.backend.factorStatistics())
    EXPECT_EQ(statistics.count, before.at(kind).count) << kind;
  EXPECT_EQ(run.newest.graph_digest, digest);
}

// A corridor in any heading whose mid-plane passes through the map's origin (mistake 4).
TEST(BackendRoomsTest, ACorridorThroughTheOriginHasItsCentre) {
  for (const double heading : {0.0, M_PI / 4}) {
    const RoomWorld world =
        makeRoomWorld({boxRoom(-4.0, -1, 8, 2)}, {{0, 9}}, {.start_heading_rad = heading});
    RoomRun run;
    for (size_t k = 0; k < 6; ++k) run.step(world, k);
    Rooms rooms = seenRooms(world, run.graph(), run.round - 1);
    rooms.rooms = {seenRoom(world, 0, run.graph(), RoomId{3}, RoomKind::kInfinite, KeyframeId{4})};
    run.step(world, 6, rooms);
    EXPECT_EQ(run.count("room_wall_infinite"), 2);
    EXPECT_LT((run.graph().rooms.at(RoomId{3}).center_map - rooms.rooms[0].center_map).norm(), 1e-3);
  }
}

TEST(BackendRoomsTest, TheSameInputGivesTheSameDigest) {
  const RoomWorld world = twoRooms({.noise = true});
  RoomRun a, b, c;
  a.all(world, true);
  b.all(world, true);
  c.all(world, false);
  EXPECT_EQ(a.newest.graph_digest, b.newest.graph_digest);
  EXPECT_NE(a.newest.graph_digest, c.newest.graph_digest);
}

TEST(BackendRoomsTest, WithoutFactorsRoomsAreOnlyReported) {
  const RoomWorld world = twoRooms({.noise = true});
  BackendConfig config;
  config.rooms.factors = config.floors.factors = false;
  RoomRun run(config), without;
  run.all(world, true);
  without.all(world, false);
  EXPECT_EQ(run.graph().rooms.size(), 2u);
  EXPECT_EQ(run.count("room_wall") + run.count("room_shape") + run.count("floor_wall"), 0);
  EXPECT_EQ(between(run.graph(), without.graph()).m, 0.0);
}

// By design storeys pull at nothing.
TEST(BackendRoomsTest, StoreysMakeNoDifferenceToPoses) {
  const RoomWorld world = twoRooms({.noise = true});
  BackendConfig rooms_only;
  rooms_only.floors.factors = false;
  RoomRun rooms(rooms_only), floors;
  rooms.all(world, true);
  floors.all(world, true);
  EXPECT_EQ(rooms.count("floor_wall"), 0);
  EXPECT_LT(between(rooms.graph(), floors.graph()).m, 1e-3);
}

TEST(BackendRoomsTest, WhatCannotBeIsNamedAndLeftOut) {
  const RoomWorld world = twoRooms();
  RoomRun run;
  for (size_t k = 0; k < 6; ++k) run.step(world, k);
  Rooms rooms = seenRooms(world, run.graph(), run.round - 1);
  RoomObservation nan = rooms.rooms[0], nowhere = rooms.rooms[0], stranger = rooms.rooms[0];
  nan.id = RoomId{7};
  nan.center_map.x() = std::nan("");
  nowhere.id = RoomId{8};
  nowhere.floor = FloorId{9};
  stranger.id = RoomId{9};
  for (auto& [a, b] : stranger.pairs) a = b = PlaneId{1000};
  for (RoomCorner& corner : stranger.polygon) corner.wall = PlaneId{1000};
  rooms.rooms.insert(rooms.rooms.end(), {nan, nowhere, stranger, rooms.rooms[0]});
  rooms.keyframe_floors.push_back({KeyframeId{77}, FloorId{0}});
  run.step(world, 6, rooms);
  EXPECT_EQ(run.newest.refused.size(), 4u);
  EXPECT_EQ(run.graph().rooms.size(), 2u);  // the stranger has no walls, but a place
  run.graph().check();
}

}  // namespace
}  // namespace sgraphs
