#include "perception/rooms/room_finder.h"

#include <gtest/gtest.h>

#include "tests/perception/rooms/plan_world.h"

namespace sgraphs::test {
namespace {

using Points = std::vector<Eigen::Vector2d>;

simulate::Doorway doorAt(double x, double y, double width) {
  simulate::Doorway door;
  door.xyz = {x, y, 0.0};
  door.width_m = width;
  return door;
}

Rooms settled(const PlanWorld& world, RoomsConfig config = {}) {
  RoomFinder finder(config);
  finder.step(world.free_space, world.update);
  return finder.step(world.free_space, idleRound(1));
}

void setClusters(FreeSpace& free_space, const std::vector<FreeSpaceCluster>& clusters) {
  free_space.clusters.clear();
  for (const FreeSpaceCluster& cluster : clusters) free_space.clusters[cluster.id] = cluster;
}

// Walls around a room, seen from inside, with ids from `first_id`.
void addWalls(MapUpdate& update, const Points& room, int64_t first_id) {
  for (size_t i = 0; i < room.size(); ++i)
    update.planes.push_back(
        wallPlane(PlaneId{first_id + static_cast<int64_t>(i)}, room[i], room[(i + 1) % room.size()]));
}

TEST(RoomFinderTest, RectangleIsFiniteAndItsCentreDoesNotDependOnTheMap) {
  const simulate::Scene scene = sceneOf({rectangle(0, 0, 5, 3)});
  for (const double heading : {0.0, M_PI / 6, M_PI / 4, M_PI / 2, 2.5})
    for (const Eigen::Vector2d& offset :
         {Eigen::Vector2d(0, 0), Eigen::Vector2d(-2.5, -1.5), Eigen::Vector2d(80, -41)}) {
      const Rooms rooms = settled(worldOf(scene, {.heading_rad = heading, .offset_m = offset}));
      ASSERT_EQ(rooms.rooms.size(), 1u);
      const RoomObservation& room = rooms.rooms[0];
      EXPECT_EQ(room.kind, RoomKind::kFinite);
      EXPECT_EQ(room.pairs.size(), 2u);
      EXPECT_EQ(room.walls().size(), 4u);
      EXPECT_NEAR(room.area_m2, 15.0, 1e-4);
      const Eigen::Vector2d center = Eigen::Rotation2Dd(heading) * Eigen::Vector2d(2.5, 1.5) + offset;
      EXPECT_LT((room.center_map - center).norm(), 1e-4);
      EXPECT_GT(polygonArea(polygonOf(room)), 0) << "counter-clockwise";
    }
}

TEST(RoomFinderTest, CorridorWithOpenEndsIsInfiniteEvenIfItsMidPlanePassesThroughTheOrigin) {
  for (const double heading : {0.0, M_PI / 4, 1.0}) {
    const Eigen::Rotation2Dd turn(heading);
    FreeSpace free_space;
    const auto placed = [&turn](Points points) {
      for (Eigen::Vector2d& p : points) p = turn * p;
      return points;
    };
    FreeSpaceCluster corridor =
        clusterOf(0, placed(rectangle(-3, -0.95, 9, 0.95)),
                  {BorderKind::kObstacle, BorderKind::kPassage, BorderKind::kObstacle, BorderKind::kPassage});
    corridor.is_corridor = true;
    setClusters(free_space, {corridor});
    MapUpdate update;
    update.keyframes = {keyframeAt(0, turn * Eigen::Vector2d(0.4, 0.1))};
    update.planes = {wallPlane(PlaneId{4}, turn * Eigen::Vector2d(-9, -1), turn * Eigen::Vector2d(20, -1)),
                     wallPlane(PlaneId{7}, turn * Eigen::Vector2d(20, 1), turn * Eigen::Vector2d(-9, 1))};
    RoomFinder finder(RoomsConfig{});
    finder.step(free_space, update);
    const Rooms rooms = finder.step(free_space, idleRound(1));
    ASSERT_EQ(rooms.rooms.size(), 1u);
    const RoomObservation& room = rooms.rooms[0];
    EXPECT_EQ(room.kind, RoomKind::kInfinite);
    EXPECT_EQ(room.pairs, (std::vector<std::pair<PlaneId, PlaneId>>{{PlaneId{4}, PlaneId{7}}}));
    EXPECT_LT((room.center_map - turn * Eigen::Vector2d(3, 0)).norm(), 1e-5);
    EXPECT_NEAR(room.area_m2, 24.0, 0.1) << "from wall to wall, and where the cluster ends";
    EXPECT_EQ(room.anchor, KeyframeId{0});
  }
}

TEST(RoomFinderTest, OtherRingsOfWallsArePolygons) {
  const Points trapezoid{{0, 0}, {6, 0}, {6, 3}, {0, 4.5}};
  const Points l_shape{{0, 0}, {6, 0}, {6, 3}, {3, 3}, {3, 6}, {0, 6}};
  Points hexagon;
  for (int k = 0; k < 6; ++k) hexagon.emplace_back(3 * std::cos(k * M_PI / 3), 3 * std::sin(k * M_PI / 3));
  for (const Points& room : {trapezoid, l_shape, hexagon}) {
    const PlanWorld world = worldOf(sceneOf({room}), {.heading_rad = 0.4});
    const Rooms rooms = settled(world);
    ASSERT_EQ(rooms.rooms.size(), 1u);
    EXPECT_EQ(rooms.rooms[0].kind, RoomKind::kPolygon);
    EXPECT_TRUE(rooms.rooms[0].pairs.empty());
    EXPECT_EQ(rooms.rooms[0].polygon.size(), room.size());
    EXPECT_EQ(rooms.rooms[0].walls().size(), room.size());
    EXPECT_GT(iou(polygonOf(rooms.rooms[0]), world.rooms[0].polygon_map), 0.999);
  }
}

TEST(RoomFinderTest, FurnitureColumnsAndADoorLeafLeaveARectangleAsItIs) {
  simulate::Scene scene = sceneOf({rectangle(0, 0, 6, 5)});
  const auto box = [&scene](const Eigen::Vector2d& center, const Eigen::Vector2d& size, double height) {
    scene.boxes.push_back({"", center, size, 0.0, height, 0.0});
  };
  box({1.5, 0.3}, {2.0, 0.56}, 2.0);  // cabinet
  box({3.0, 2.5}, {0.4, 0.4}, 2.8);   // column
  box({5.2, 4.2}, {1.5, 1.5}, 0.6);   // bed in the corner
  box({0.5, 2.6}, {0.9, 0.05}, 2.0);  // open door leaf
  const PlanWorld world = worldOf(scene, {.heading_rad = 0.5});
  const Rooms rooms = settled(world);
  ASSERT_EQ(rooms.rooms.size(), 1u);
  EXPECT_EQ(rooms.rooms[0].kind, RoomKind::kFinite);
  EXPECT_GT(iou(polygonOf(rooms.rooms[0]), world.rooms[0].polygon_map), 0.999);
}

TEST(RoomFinderTest, SomebodyAtAWallOrInTheDoorLeavesTheRoomAsItIs) {
  FreeSpace free_space;
  setClusters(free_space, {clusterOf(0, {{0.05, 0.05},
                                         {2.0, 0.05},
                                         {2.1, 0.6},
                                         {2.5, 0.6},
                                         {2.6, 0.05},
                                         {4.95, 0.05},
                                         {4.95, 1.0},
                                         {4.5, 1.1},
                                         {4.5, 1.5},
                                         {4.95, 1.6},
                                         {4.95, 3.95},
                                         {0.05, 3.95}})});
  MapUpdate update;
  update.keyframes = {keyframeAt(0, {1, 1})};
  addWalls(update, rectangle(0, 0, 5, 4), 0);
  RoomFinder finder(RoomsConfig{});
  finder.step(free_space, update);
  const Rooms rooms = finder.step(free_space, idleRound(1));
  ASSERT_EQ(rooms.rooms.size(), 1u);
  EXPECT_EQ(rooms.rooms[0].kind, RoomKind::kFinite);
  EXPECT_NEAR(rooms.rooms[0].area_m2, 20.0, 1e-6);
}

TEST(RoomFinderTest, RoomWithAGlassWallIsInfiniteAndEndsAtTheGlass) {
  simulate::Scene scene = sceneOf({rectangle(0, 0, 5, 4)});
  scene.walls[1].glass = true;
  const PlanWorld world = worldOf(scene, {.heading_rad = 0.7});
  const Rooms rooms = settled(world);
  ASSERT_EQ(rooms.rooms.size(), 1u);
  EXPECT_EQ(rooms.rooms[0].kind, RoomKind::kInfinite);
  EXPECT_EQ(rooms.rooms[0].walls().size(), 3u);
  EXPECT_GT(iou(polygonOf(rooms.rooms[0]), world.rooms[0].polygon_map), 0.95);
}

TEST(RoomFinderTest, ClosetIsARoomAndAShaftIsNone) {
  const Rooms closet = settled(worldOf(sceneOf({rectangle(0, 0, 1.2, 1.6)}), {}));
  ASSERT_EQ(closet.rooms.size(), 1u);
  EXPECT_NEAR(closet.rooms[0].area_m2, 1.92, 1e-4);
  EXPECT_TRUE(settled(worldOf(sceneOf({rectangle(0, 0, 0.9, 1.2)}), {})).rooms.empty());
}

TEST(RoomFinderTest, RoomsJoinedByAWideOpeningStayTwoWithADoorwayInTheMiddleOfTheWall) {
  simulate::Scene scene = sceneOf({rectangle(0, 0, 5, 4), rectangle(5.2, 0, 9, 4)}, 0.2);
  scene.doorways = {doorAt(5.1, 2, 2.2)};
  const PlanWorld world = worldOf(scene, {.heading_rad = 0.3});
  const Rooms rooms = settled(world);
  ASSERT_EQ(rooms.rooms.size(), 2u);
  ASSERT_EQ(rooms.doorways.size(), 1u);
  EXPECT_EQ(rooms.doorways[0].a, rooms.rooms[0].id);
  EXPECT_EQ(rooms.doorways[0].b, rooms.rooms[1].id);
  EXPECT_LT((rooms.doorways[0].position_map.head<2>() - world.doorways[0].position_map).norm(), 1e-4)
      << "although the free space had it 0.15 m off";
  EXPECT_NEAR(rooms.doorways[0].width_m, 2.2, 1e-4);
}

TEST(RoomFinderTest, PassagesInsideOneRoomAreNoDoorways) {
  simulate::Scene scene = sceneOf({rectangle(0, 0, 5, 4), rectangle(5.1, 0, 9, 4)});
  scene.doorways = {doorAt(5.05, 2, 1.0)};
  PlanWorld world = worldOf(scene, {});
  world.free_space.passages.begin()->second.is_door = false;
  EXPECT_TRUE(settled(world).doorways.empty());
}

// Two arms of a corridor, 2 m wide, cut at x = 5.
TEST(RoomFinderTest, OpenEndOfACorridorIsNoDoorwayAndADoorInItsEndWallIsOne) {
  FreeSpace free_space;
  const std::vector<BorderKind> kinds_a{BorderKind::kObstacle, BorderKind::kPassage, BorderKind::kObstacle,
                                        BorderKind::kObstacle};
  const std::vector<BorderKind> kinds_b{BorderKind::kObstacle, BorderKind::kObstacle, BorderKind::kObstacle,
                                        BorderKind::kPassage};
  setClusters(free_space,
              {clusterOf(0, rectangle(0, 0, 5, 2), kinds_a), clusterOf(1, rectangle(5, 0, 12, 2), kinds_b)});
  Passage passage{PassageId{0}, FloorId{0}, ClusterId{0}, ClusterId{1}};
  passage.left_map = {5.4f, 0.1f};
  passage.right_map = {5.4f, 1.9f};
  free_space.passages[passage.id] = passage;
  MapUpdate update;
  update.keyframes = {keyframeAt(0, {1, 1}), keyframeAt(1, {8, 1})};
  addWalls(update, rectangle(0, 0, 12, 2), 0);
  RoomFinder finder(RoomsConfig{});
  finder.step(free_space, update);
  Rooms rooms = finder.step(free_space, idleRound(1));
  ASSERT_EQ(rooms.rooms.size(), 2u);
  EXPECT_TRUE(rooms.doorways.empty());
  setClusters(free_space, {clusterOf(0, {{0, 0}, {5, 0}, {5, 0.5}, {5, 1.5}, {5, 2}, {0, 2}},
                                     {BorderKind::kObstacle, BorderKind::kObstacle, BorderKind::kPassage,
                                      BorderKind::kObstacle, BorderKind::kObstacle, BorderKind::kObstacle}),
                           free_space.clusters.at(ClusterId{1})});
  free_space.passages[passage.id].left_map.y() = 0.5f;
  free_space.passages[passage.id].right_map.y() = 1.5f;
  MapUpdate end_wall = idleRound(2);
  end_wall.planes = {wallPlane(PlaneId{10}, {5, 0}, {5, 2})};
  finder.step(free_space, end_wall);
  rooms = finder.step(free_space, idleRound(3));
  ASSERT_EQ(rooms.doorways.size(), 1u);
  EXPECT_LT((rooms.doorways[0].position_map.head<2>() - Eigen::Vector2d(5, 1)).norm(), 1e-5) << "in the wall";
}

TEST(RoomFinderTest, RoomSeenThroughItsDoorOnlyIsNoneUntilItIsEntered) {
  simulate::Scene scene = sceneOf({rectangle(0, 0, 5, 4), rectangle(5.1, 0, 9, 4)});
  scene.doorways = {doorAt(5.05, 2, 1.0)};
  PlanWorld world = worldOf(scene, {});
  const MapKeyframe inside = world.update.keyframes[1];
  world.update.keyframes.resize(1);
  RoomFinder finder(RoomsConfig{});
  finder.step(world.free_space, world.update);
  Rooms rooms = finder.step(world.free_space, idleRound(1));
  ASSERT_EQ(rooms.rooms.size(), 1u);
  ASSERT_EQ(rooms.doorways.size(), 1u);
  EXPECT_FALSE(rooms.doorways[0].b.valid());
  MapUpdate entered = idleRound(2);
  entered.keyframes = {inside};
  rooms = finder.step(world.free_space, entered);
  ASSERT_EQ(rooms.rooms.size(), 2u) << "it was seen well before";
  EXPECT_EQ(rooms.rooms[1].accepted, Time{2000000});
  EXPECT_TRUE(rooms.doorways[0].b.valid());
}

TEST(RoomFinderTest, WedgeThroughADoorIsNoRoomEvenWithTheRobotOnTheThreshold) {
  FreeSpace free_space;
  setClusters(free_space, {clusterOf(0, {{2, 0}, {3, 0}, {4.9, 4.9}, {0.1, 4.9}},
                                     {BorderKind::kPassage, BorderKind::kFrontier, BorderKind::kObstacle,
                                      BorderKind::kFrontier})});
  MapUpdate update;
  update.keyframes = {keyframeAt(0, {2.5, 0.1})};
  addWalls(update, rectangle(0, 0, 5, 5), 0);
  RoomFinder finder(RoomsConfig{});
  finder.step(free_space, update);
  EXPECT_TRUE(finder.step(free_space, idleRound(1)).rooms.empty());
}

TEST(RoomFinderTest, CornerThatNobodySawIsClosedByItsWalls) {
  FreeSpace free_space;
  setClusters(free_space, {clusterOf(0, {{0.05, 0.05}, {4.95, 0.05}, {4.95, 2.9}, {4.0, 3.95}, {0.05, 3.95}},
                                     {BorderKind::kObstacle, BorderKind::kObstacle, BorderKind::kFrontier,
                                      BorderKind::kObstacle, BorderKind::kObstacle})});
  MapUpdate update;
  update.keyframes = {keyframeAt(0, {1, 1})};
  addWalls(update, rectangle(0, 0, 5, 4), 0);
  RoomFinder finder(RoomsConfig{});
  finder.step(free_space, update);
  const Rooms rooms = finder.step(free_space, idleRound(1));
  ASSERT_EQ(rooms.rooms.size(), 1u);
  EXPECT_NEAR(rooms.rooms[0].area_m2, 20.0, 1e-6);
}

// Racks hide a corner of a hall, a quarter of its border: enough if its walls are known, too much if one is
// not.
TEST(RoomFinderTest, MoreMayBeUnseenInAClosedRoomThanInAnOpenOne) {
  for (const bool closed : {true, false}) {
    FreeSpace free_space;
    setClusters(free_space, {clusterOf(0, {{0.1, 0.1}, {19.9, 0.1}, {19.9, 5.0}, {6.0, 9.9}, {0.1, 9.9}},
                                       {BorderKind::kObstacle, BorderKind::kObstacle, BorderKind::kFrontier,
                                        BorderKind::kObstacle, BorderKind::kObstacle})});
    MapUpdate update;
    update.keyframes = {keyframeAt(0, {1, 1})};
    addWalls(update, rectangle(0, 0, 20, 10), 0);
    if (!closed) update.planes.erase(update.planes.begin() + 3);
    RoomFinder finder(RoomsConfig{});
    finder.step(free_space, update);
    const Rooms rooms = finder.step(free_space, idleRound(1));
    ASSERT_EQ(rooms.rooms.size(), closed ? 1u : 0u);
    if (closed) {
      EXPECT_NEAR(rooms.rooms[0].area_m2, 200.0, 1e-3);
    }
  }
}

TEST(RoomFinderTest, TurnedByAnyAngleTheRoomsAreTheSame) {
  const Rooms straight = settled(worldOf("small_office", {}));
  for (const double heading : {M_PI / 6, M_PI / 4, M_PI / 2}) {
    const Rooms turned = settled(worldOf("small_office", {.heading_rad = heading}));
    ASSERT_EQ(turned.rooms.size(), straight.rooms.size());
    for (size_t i = 0; i < turned.rooms.size(); ++i) {
      EXPECT_EQ(turned.rooms[i].kind, straight.rooms[i].kind);
      EXPECT_EQ(turned.rooms[i].walls(), straight.rooms[i].walls());
      EXPECT_NEAR(turned.rooms[i].area_m2, straight.rooms[i].area_m2, 0.01 * straight.rooms[i].area_m2);
    }
  }
}

TEST(RoomFinderTest, WallOfTheNextRoomIsNoneOfThisOne) {
  // A shaft of 0.5 m behind the right wall: its far wall faces the same way.
  const PlanWorld world = worldOf(sceneOf({rectangle(0, 0, 4, 4), rectangle(4.1, 0, 4.6, 4)}), {});
  const Rooms rooms = settled(world);
  ASSERT_FALSE(rooms.rooms.empty());
  EXPECT_NEAR(rooms.rooms[0].area_m2, 16.0, 1e-4);
}

// methods.md 7.3: what was matched to one room says nothing of the next.
TEST(RoomFinderTest, EachRoomIsTheSameWhetherOrNotThereAreOthers) {
  const PlanWorld world = worldOf("se1", {.heading_rad = 0.5});
  const Rooms together = settled(world);
  size_t alone = 0;
  for (const auto& [id, cluster] : world.free_space.clusters) {
    PlanWorld only = world;
    setClusters(only.free_space, {cluster});
    const Rooms rooms = settled(only);
    ASSERT_LE(rooms.rooms.size(), 1u);
    if (rooms.rooms.empty()) continue;
    const auto same =
        std::find_if(together.rooms.begin(), together.rooms.end(),
                     [&](const RoomObservation& r) { return polygonOf(r) == polygonOf(rooms.rooms[0]); });
    ASSERT_NE(same, together.rooms.end());
    EXPECT_EQ(same->walls(), rooms.rooms[0].walls());
    ++alone;
  }
  EXPECT_EQ(alone, together.rooms.size());
}

TEST(RoomFinderTest, SameInputsGiveTheSameRooms) {
  const PlanWorld world = worldOf("small_office", {.heading_rad = 1.2});
  const Rooms a = settled(world), b = settled(world);
  ASSERT_EQ(a.rooms.size(), b.rooms.size());
  for (size_t i = 0; i < a.rooms.size(); ++i) {
    EXPECT_EQ(polygonOf(a.rooms[i]), polygonOf(b.rooms[i]));
    EXPECT_EQ(a.rooms[i].center_map, b.rooms[i].center_map);
  }
}

TEST(RoomFinderTest, WithAWindowNewRoomsNeedWallsOfTheLastKeyframes) {
  RoomsConfig config;
  config.window_keyframes = 3;
  PlanWorld world = worldOf(sceneOf({rectangle(0, 0, 5, 4), rectangle(10, 0, 15, 4)}), {});
  const FreeSpaceCluster late = world.free_space.clusters.at(ClusterId{1});
  world.free_space.clusters.erase(ClusterId{1});
  RoomFinder finder(config);
  finder.step(world.free_space, world.update);
  ASSERT_EQ(finder.step(world.free_space, idleRound(1)).rooms.size(), 1u);
  MapUpdate walk = idleRound(2);
  for (int64_t i = 2; i < 6; ++i)
    walk.keyframes.push_back(keyframeAt(i, world.update.keyframes[1].T_map_body.translation.head<2>()));
  world.free_space.clusters[ClusterId{1}] = late;
  finder.step(world.free_space, walk);
  Rooms rooms;
  for (int64_t round = 3; round < 20; ++round) rooms = finder.step(world.free_space, idleRound(round));
  EXPECT_EQ(rooms.rooms.size(), 1u) << "the first stays, the second one's walls are too old";
  MapUpdate again = idleRound(20);
  again.planes = world.update.planes;
  finder.step(world.free_space, again);
  EXPECT_EQ(finder.step(world.free_space, idleRound(21)).rooms.size(), 2u);
}

}  // namespace
}  // namespace sgraphs::test
