// Rooms seen twice, and rooms that only look alike.
#include <gtest/gtest.h>

#include "backend/rooms/room_association.h"
#include "tests/backend/rooms/room_world.h"

namespace sgraphs {
namespace {

using testing_support::boxRoom;
using testing_support::makeRoomWorld;
using testing_support::RoomRun;
using testing_support::RoomWorld;
using testing_support::seenRoom;
using testing_support::seenRooms;

double worst_m(const SituationalGraph& graph, const RoomWorld& world) {
  double worst = 0;
  for (const auto& [id, node] : graph.keyframes) {
    const SE3 truth = world.truth[0].inverse() * world.truth[static_cast<size_t>(id.value)];
    worst = std::max(worst, (node.T_map_body.translation - truth.translation).norm());
  }
  return worst;
}

// The robot leaves room 0, and comes back with a drift of some 0.66 m along each axis, 7 sigma: its walls are
// mapped twice. Then the room is seen twice, once by the keyframes of the first visit and once by those of
// the second.
struct Revisit {
  RoomWorld world =
      makeRoomWorld({boxRoom(0, 0, 5, 6), boxRoom(30, 0, 7, 4), boxRoom(60, 3, 6, 9)},
                    {{0, 6}, {1, 9}, {2, 9}, {0, 6}}, {.drift_m = 0.22, .odometry_sigma_m = 0.02});
  RoomRun run;
  size_t second = 24;  // first keyframe of the second visit

  std::optional<Rooms> rooms() const {
    if (run.round == 0) return std::nullopt;
    Rooms seen = seenRooms(world, run.graph(), run.round - 1);
    const KeyframeId again{static_cast<int64_t>(second)};
    if (run.graph().keyframes.contains(KeyframeId{again.value + 1}))
      seen.rooms.push_back(seenRoom(world, 0, run.graph(), RoomId{9}, RoomKind::kFinite, again));
    return seen;
  }
};

TEST(RoomLoopTest, ARoomSeenTwiceClosesTheLoopByItsWalls) {
  Revisit with, without;
  for (size_t k = 0; k < with.world.keyframes.size(); ++k) {
    with.run.step(with.world, k, with.rooms());
    without.run.step(without.world, k);
  }
  for (int i = 0; i < 4; ++i) {
    with.run.idle(with.rooms());
    without.run.idle();
  }
  with.run.graph().check();
  // Two walls lie along the drift.
  EXPECT_EQ(with.run.graph().planes.size(), 15u);
  EXPECT_EQ(without.run.graph().planes.size(), 17u);
  EXPECT_EQ(with.run.graph().merged_planes.size(), 2u);
  EXPECT_EQ(with.run.graph().rooms.size(), 3u);
  EXPECT_FALSE(with.run.graph().rooms.contains(RoomId{9}));
  EXPECT_EQ(with.run.count("room_wall"), 6);
  EXPECT_GT(worst_m(without.run.graph(), without.world), 0.5);
  const double back_m = (with.run.graph().keyframes.rbegin()->second.T_map_body.translation -
                         (with.world.truth[0].inverse() * with.world.truth.back()).translation)
                            .norm();
  EXPECT_LT(back_m, 0.03);
}

// Once is chance: a single round merges nothing, and neither do two that do not follow each other.
TEST(RoomLoopTest, OneRoundIsNotEvidenceEnough) {
  Revisit revisit;
  for (size_t k = 0; k < revisit.world.keyframes.size(); ++k) {
    std::optional<Rooms> rooms = revisit.rooms();
    if (k % 2 == 0 && rooms) std::erase_if(rooms->rooms, [](const auto& r) { return r.id == RoomId{9}; });
    revisit.run.step(revisit.world, k, rooms);
  }
  EXPECT_TRUE(revisit.run.graph().merged_planes.empty());
}

// Mistake 3 of earlier systems: offices all alike, side by side, are as many rooms as there are.
TEST(RoomLoopTest, OfficesAllAlikeStayApart) {
  std::vector<testing_support::WorldRoom> offices;
  std::vector<testing_support::Visit> visits;
  for (int i = 0; i < 5; ++i) {
    offices.push_back(boxRoom(1.3 * i, 0, 1.2, 4));  // narrow, so that centres are near each other
    visits.push_back({static_cast<size_t>(i), 5});
  }
  const RoomWorld world = makeRoomWorld(offices, visits);
  RoomRun run;
  run.all(world, true);
  EXPECT_EQ(run.graph().rooms.size(), 5u);
  EXPECT_TRUE(run.graph().merged_planes.empty());
}

TEST(RoomLoopTest, RoomsOfOtherSizeOrStoreyAreNotTheSame) {
  const RoomWorld world = makeRoomWorld(
      {boxRoom(0, 0, 5, 6), boxRoom(0.1, 0.1, 5.3, 6), boxRoom(0, 0, 5, 6, 1)}, {{0, 5}, {1, 5}, {2, 5}});
  RoomRun run;
  run.all(world, false);
  const auto& graph = run.graph();
  const auto seen = [&](size_t r) {
    return seenRoom(world, r, graph, RoomId{static_cast<int64_t>(r)}, RoomKind::kFinite,
                    KeyframeId{static_cast<int64_t>(5 * r)});
  };
  EXPECT_FALSE(wallsOfSameRoom(seen(0), seen(1), graph.planes, 1.0));
  EXPECT_FALSE(wallsOfSameRoom(seen(0), seen(2), graph.planes, 1.0));
  RoomObservation again = seen(0);
  again.id = RoomId{5};
  ASSERT_TRUE(wallsOfSameRoom(seen(0), again, graph.planes, 1.0));
  EXPECT_EQ(wallsOfSameRoom(seen(0), again, graph.planes, 1.0)->size(), 4u);
  again.kind = RoomKind::kInfinite;
  EXPECT_FALSE(wallsOfSameRoom(seen(0), again, graph.planes, 1.0));
}

}  // namespace
}  // namespace sgraphs
