#include <gtest/gtest.h>

#include <set>
#include <string>

#include "perception/rooms/room_finder.h"
#include "tests/perception/rooms/plan_world.h"

namespace sgraphs::test {
namespace {

// Two rounds in which nothing moves: what is stable by then is accepted.
Rooms found(const PlanWorld& world, RoomsConfig config = {}) {
  RoomFinder finder(config);
  finder.step(world.free_space, world.update);
  return finder.step(world.free_space, idleRound(1));
}

// The room that shares most with a true one, and how much: intersection over union.
std::pair<size_t, double> bestOf(const Rooms& rooms, const TrueRoom& truth) {
  std::pair<size_t, double> best{rooms.rooms.size(), 0.0};
  for (size_t i = 0; i < rooms.rooms.size(); ++i) {
    if (rooms.rooms[i].floor != truth.floor) continue;
    const double value = iou(polygonOf(rooms.rooms[i]), truth.polygon_map);
    if (value > best.second) best = {i, value};
  }
  return best;
}

// Two metres of hallway, which nobody stops in: a room of its own or part of a neighbour.
bool isOptional(const std::string& scene, const std::string& id) {
  return scene == "turtlebot3_house" && id == "C_1";
}

class RoomScenesTest : public testing::TestWithParam<std::tuple<const char*, int>> {};

TEST_P(RoomScenesTest, AllRoomsAndDoorways) {
  const auto [scene, heading_deg] = GetParam();
  const PlanWorld world = worldOf(scene, {.heading_rad = heading_deg * M_PI / 180});
  const Rooms rooms = found(world);
  std::set<size_t> matched;
  for (const TrueRoom& truth : world.rooms) {
    if (isOptional(scene, truth.id)) continue;
    const auto [index, value] = bestOf(rooms, truth);
    const bool corridor = truth.id.rfind("C_", 0) == 0;
    EXPECT_GE(value, corridor ? 0.5 : 0.9) << truth.id;
    EXPECT_TRUE(matched.insert(index).second) << truth.id << ": found in a room that is another already";
  }
  EXPECT_EQ(matched.size(), rooms.rooms.size()) << "and no other rooms";

  ASSERT_EQ(rooms.doorways.size(), world.doorways.size());
  const bool all_rooms = scene != std::string("turtlebot3_house");
  for (size_t i = 0; i < rooms.doorways.size(); ++i) {
    const Doorway& doorway = rooms.doorways[i];
    EXPECT_LT((doorway.position_map.head<2>() - world.doorways[i].position_map).norm(), 0.2);
    EXPECT_NEAR(doorway.width_m, world.doorways[i].width_m, 0.01);
    EXPECT_TRUE(doorway.a.valid());
    EXPECT_TRUE(!all_rooms || doorway.a < doorway.b);
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, RoomScenesTest,
                         testing::Combine(testing::Values("cf1", "cf2", "se1", "se2", "lc1", "two_storeys",
                                                          "turned", "offices20", "turtlebot3_house",
                                                          "small_office", "two_rooms", "hall"),
                                          testing::Values(0, 30)));

}  // namespace
}  // namespace sgraphs::test
