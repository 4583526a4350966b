#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>

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

struct Score {
  int found = 0, missed = 0, wrong = 0;
  double least_iou = 1;
};

Score scoreOf(const PlanWorld& world, const Rooms& rooms) {
  Score score;
  std::vector<bool> used(rooms.rooms.size(), false);
  for (const TrueRoom& truth : world.rooms) {
    double best = 0;
    size_t which = 0;
    for (size_t i = 0; i < rooms.rooms.size(); ++i) {
      if (used[i] || rooms.rooms[i].floor != truth.floor) continue;
      const double value = iou(polygonOf(rooms.rooms[i]), truth.polygon_map);
      if (value <= best) continue;
      best = value;
      which = i;
    }
    if (best > 0.5) used[which] = true;
    const bool corridor = truth.id.rfind("C_", 0) == 0;
    if (best < 0.9 && !corridor) std::printf("%s: %.3f\n", truth.id.c_str(), best);
    if (corridor) continue;
    best > 0.5 ? ++score.found : ++score.missed;
    score.least_iou = std::min(score.least_iou, best);
  }
  for (const bool u : used) score.wrong += !u;
  return score;
}

class RoomScenesTest : public testing::TestWithParam<std::tuple<const char*, int>> {};

TEST_P(RoomScenesTest, AllRoomsAndDoorways) {
  const auto [scene, heading_deg] = GetParam();
  const PlanWorld world = worldOf(scene, {.heading_rad = heading_deg * M_PI / 180});
  const Rooms rooms = found(world);
  if (const char* folder = std::getenv("SGRAPHS_DRAW_ROOMS")) {
    std::ofstream out(std::string(folder) + "/" + scene + "_" + std::to_string(heading_deg) + ".txt");
    for (const auto& [id, cluster] : world.free_space.clusters) {
      out << "cluster";
      for (const auto& c : cluster.border) out << " " << c.position_map.x() << " " << c.position_map.y();
      out << "\n";
    }
    for (const auto& t : world.rooms) {
      out << "truth";
      for (const auto& c : t.polygon_map) out << " " << c.x() << " " << c.y();
      out << "\n";
    }
    for (const auto& r : rooms.rooms) {
      out << "room";
      for (const auto& c : r.polygon) out << " " << c.position_map.x() << " " << c.position_map.y();
      out << "\n";
    }
  }
  const Score score = scoreOf(world, rooms);
  EXPECT_EQ(score.missed, 0);
  EXPECT_EQ(score.wrong, 0);
  EXPECT_GE(score.least_iou, 0.9);

  ASSERT_EQ(rooms.doorways.size(), world.doorways.size());
  for (size_t i = 0; i < rooms.doorways.size(); ++i) {
    const Doorway& doorway = rooms.doorways[i];
    EXPECT_LT((doorway.position_map.head<2>() - world.doorways[i].position_map).norm(), 0.2);
    EXPECT_NEAR(doorway.width_m, world.doorways[i].width_m, 0.01);
    EXPECT_LT(doorway.a, doorway.b);
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, RoomScenesTest,
                         testing::Combine(testing::Values("cf1", "cf2", "se1", "se2", "lc1", "two_storeys",
                                                          "turned", "offices20", "turtlebot3_house",
                                                          "small_office", "two_rooms", "hall"),
                                          testing::Values(0, 30)));

}  // namespace
}  // namespace sgraphs::test
