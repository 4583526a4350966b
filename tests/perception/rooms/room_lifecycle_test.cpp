#include <gtest/gtest.h>

#include "perception/rooms/room_finder.h"
#include "tests/perception/rooms/plan_world.h"

namespace sgraphs::test {
namespace {

using Points = std::vector<Eigen::Vector2d>;

MapPlane mergedPlane(int64_t id, int64_t into) {
  MapPlane plane;
  plane.id = PlaneId{id};
  plane.merged_into = PlaneId{into};
  return plane;
}

// A finder with its inputs from round to round.
class RoomLifecycleTest : public testing::Test {
 protected:
  void addWalls(const Points& room, int64_t first_id) {
    for (size_t i = 0; i < room.size(); ++i)
      addWall(first_id + static_cast<int64_t>(i), room[i], room[(i + 1) % room.size()]);
  }
  void addWall(int64_t id, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    next_.planes.push_back(wallPlane(PlaneId{id}, a, b));
  }
  void enter(const Eigen::Vector2d& p) { next_.keyframes.push_back(keyframeAt(keyframes_++, p)); }
  void setClusters(const std::vector<FreeSpaceCluster>& clusters) {
    free_space_.clusters.clear();
    for (const FreeSpaceCluster& cluster : clusters) free_space_.clusters[cluster.id] = cluster;
  }
  const Rooms& step(int rounds = 1) {
    for (int i = 0; i < rounds; ++i) {
      next_.round = round_;
      next_.time = Time{1000000 * round_++};
      rooms_ = finder_.step(free_space_, next_);
      next_ = idleRound(0);
    }
    return rooms_;
  }
  std::vector<int64_t> ids() const {
    std::vector<int64_t> ids;
    for (const RoomObservation& room : rooms_.rooms) ids.push_back(room.id.value);
    return ids;
  }

  FreeSpace free_space_;
  Rooms rooms_;
  MapUpdate next_;

 private:
  RoomFinder finder_{RoomsConfig{}};
  int64_t round_ = 0, keyframes_ = 0;
};

using Ids = std::vector<int64_t>;

TEST_F(RoomLifecycleTest, AcceptedInTheSecondRoundThatLooksAlike) {
  setClusters({clusterOf(0, rectangle(0, 0, 4, 3))});
  addWalls(rectangle(0, 0, 4, 3), 0);
  enter({1, 1});
  EXPECT_TRUE(step().rooms.empty());
  EXPECT_EQ(step().rooms.size(), 1u);
  EXPECT_EQ(rooms_.rooms[0].accepted, Time{1000000});
  EXPECT_EQ(step(3).rooms[0].accepted, Time{1000000}) << "and not again";
}

TEST_F(RoomLifecycleTest, NotAcceptedWhileItGrows) {
  addWalls(rectangle(0, 0, 9, 3), 0);
  enter({1, 1});
  for (int i = 0; i < 5; ++i) {
    setClusters({clusterOf(0, rectangle(0, 0, 3 + 1.2 * i, 3))});
    EXPECT_TRUE(step().rooms.empty());
  }
}

TEST_F(RoomLifecycleTest, InfiniteBecomesFiniteWithoutLosingItsId) {
  setClusters({clusterOf(0, rectangle(0, 0, 4, 3))});
  addWalls({{0, 3}, {0, 0}, {4, 0}}, 0);
  next_.planes.pop_back();  // walls on the left and below
  addWall(3, {4, 3}, {0, 3});
  enter({1, 1});
  ASSERT_EQ(step(2).rooms.size(), 1u);
  EXPECT_EQ(rooms_.rooms[0].kind, RoomKind::kInfinite);
  const RoomId id = rooms_.rooms[0].id;
  addWall(9, {4, 0}, {4, 3});
  ASSERT_EQ(step(2).rooms.size(), 1u);
  EXPECT_EQ(rooms_.rooms[0].id, id);
  EXPECT_EQ(rooms_.rooms[0].kind, RoomKind::kFinite);
  EXPECT_EQ(rooms_.rooms[0].pairs.size(), 2u);
}

TEST_F(RoomLifecycleTest, TwoThatTurnOutToBeOneKeepTheLowestId) {
  setClusters({clusterOf(5, rectangle(0, 0, 3, 3)), clusterOf(6, rectangle(3.1, 0, 9, 3))});
  addWalls(rectangle(0, 0, 3, 3), 0);
  addWalls(rectangle(3.1, 0, 9, 3), 10);
  enter({1, 1});
  enter({5, 1});
  step(2);
  ASSERT_EQ(ids(), (Ids{0, 1}));
  // The partition was an illusion.
  setClusters({clusterOf(6, rectangle(0, 0, 9, 3))});
  next_.planes = {mergedPlane(1, 13),
                  mergedPlane(3, 13),
                  mergedPlane(11, 13),
                  wallPlane(PlaneId{13}, {0, 3}, {0, 0}),
                  wallPlane(PlaneId{14}, {9, 0}, {9, 3}),
                  wallPlane(PlaneId{0}, {0, 0}, {9, 0}),
                  wallPlane(PlaneId{2}, {9, 3}, {0, 3})};
  step(4);
  ASSERT_EQ(ids(), (Ids{0}));
  EXPECT_NEAR(rooms_.rooms[0].area_m2, 27.0, 0.01);
}

TEST_F(RoomLifecycleTest, OneThatTurnsOutToBeTwoKeepsItsIdOnTheLargerPart) {
  setClusters({clusterOf(0, rectangle(0, 0, 9, 3))});
  addWalls(rectangle(0, 0, 9, 3), 0);
  enter({1, 1});
  enter({5, 1});
  step(2);
  ASSERT_EQ(ids(), (Ids{0}));
  setClusters({clusterOf(0, rectangle(0, 0, 3, 3)), clusterOf(1, rectangle(3.1, 0, 9, 3))});
  addWall(7, {3, 0}, {3, 3});
  addWall(8, {3.1, 3}, {3.1, 0});
  step(2);
  ASSERT_EQ(ids(), (Ids{0, 1}));
  EXPECT_NEAR(rooms_.rooms[0].area_m2, 17.7, 0.01);
  EXPECT_NEAR(rooms_.rooms[1].area_m2, 9.0, 0.01);
}

TEST_F(RoomLifecycleTest, WithdrawnAfterSomeRoundsWithoutItsClusterAndItsIdIsNotUsedAgain) {
  setClusters({clusterOf(0, rectangle(0, 0, 4, 3))});
  addWalls(rectangle(0, 0, 4, 3), 0);
  enter({1, 1});
  step(2);
  ASSERT_EQ(ids(), (Ids{0}));
  setClusters({});
  EXPECT_EQ(step(RoomsConfig{}.patience_rounds - 1).rooms.size(), 1u);
  EXPECT_TRUE(step().rooms.empty());
  setClusters({clusterOf(1, rectangle(0, 0, 4, 3))});
  step(2);
  EXPECT_EQ(ids(), (Ids{1}));
}

TEST_F(RoomLifecycleTest, ShortAbsenceIsForgivenAndANewClusterIdIsTheSameRoom) {
  setClusters({clusterOf(0, rectangle(0, 0, 4, 3))});
  addWalls(rectangle(0, 0, 4, 3), 0);
  enter({1, 1});
  step(2);
  setClusters({});
  step(2);
  setClusters({clusterOf(7, rectangle(0, 0, 4, 3))});
  for (int i = 0; i < 10; ++i) {
    step();
    ASSERT_EQ(ids(), (Ids{0}));
  }
}

TEST_F(RoomLifecycleTest, WithdrawnWhenItsWallsGo) {
  setClusters({clusterOf(0, rectangle(0, 0, 4, 3))});
  addWalls(rectangle(0, 0, 4, 3), 0);
  addWall(50, {100, 100}, {110, 100});
  enter({1, 1});
  step(2);
  for (int64_t i = 0; i < 4; ++i) next_.planes.push_back(mergedPlane(i, 50));
  EXPECT_TRUE(step(6).rooms.empty());
}

TEST_F(RoomLifecycleTest, MergedWallsKeepTheirRoomAndAreNamedByWhatTheyLiveOnIn) {
  setClusters({clusterOf(0, rectangle(0, 0, 4, 3))});
  addWalls(rectangle(0, 0, 4, 3), 4);
  enter({1, 1});
  step(2);
  next_.planes = {mergedPlane(4, 2), wallPlane(PlaneId{2}, {0, 0}, {4, 0})};
  step();
  ASSERT_EQ(ids(), (Ids{0}));
  EXPECT_EQ(rooms_.rooms[0].walls(), (std::vector<PlaneId>{{2}, {5}, {6}, {7}}));
}

TEST_F(RoomLifecycleTest, FollowsTheMapWhenItMoves) {
  setClusters({clusterOf(0, rectangle(0, 0, 4, 3))});
  addWalls(rectangle(0, 0, 4, 3), 0);
  enter({1, 1});
  step(2);
  setClusters({clusterOf(0, rectangle(0.3, 0.2, 4.3, 3.2))});
  addWalls(rectangle(0.3, 0.2, 4.3, 3.2), 0);
  step();
  ASSERT_EQ(ids(), (Ids{0}));
  EXPECT_LT((rooms_.rooms[0].center_map - Eigen::Vector2d(2.3, 1.7)).norm(), 1e-5);
}

}  // namespace
}  // namespace sgraphs::test
