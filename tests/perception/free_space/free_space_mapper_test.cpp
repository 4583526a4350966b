#include "perception/free_space/free_space_mapper.h"

#include <gtest/gtest.h>

#include "tests/perception/free_space/box_world.h"

namespace sgraphs {
namespace {

// Two rooms of 4 m with a door of 0.9 m between them, at x = 0.
BoxWorld twoRooms() {
  BoxWorld world;
  world.addRoom({-4.03, -2.04}, {4.04, 2.03});
  world.add({-0.07, -2.04, 0}, {0.07, -0.44, 2.6});
  world.add({-0.07, 0.46, 0}, {0.07, 2.03, 2.6});
  world.add({-0.07, -0.44, 2.1}, {0.07, 0.46, 2.6});
  return world;
}

MapUpdate look(int64_t id, const SE3& T_map_body) {
  MapUpdate update = updateOf({mapKeyframe(id, T_map_body)});
  update.round = id;
  update.time = {1000 * id};
  return update;
}

void walk(FreeSpaceMapper& mapper) {
  const BoxWorld world = twoRooms();
  for (int i = 0; i < 9; ++i) {
    const SE3 T = bodyAt(-3.0 + 0.75 * i, 0.1);
    mapper.step(world.keyframe(i, T), look(i, T));
  }
}

TEST(FreeSpaceMapperTest, TwoRoomsAreTwoClustersWithADoorBetween) {
  FreeSpaceMapper mapper{FreeSpaceConfig{}};
  walk(mapper);
  const FreeSpace& result = mapper.step(std::nullopt, look(9, bodyAt(0, 0)));
  EXPECT_EQ(result.round, 9);
  ASSERT_EQ(result.clusters.size(), 2u);
  for (const auto& [id, cluster] : result.clusters) EXPECT_NEAR(cluster.area_m2, 4.0 * 4.07, 1.5);
  ASSERT_EQ(result.passages.size(), 1u);
  const Passage& door = result.passages.begin()->second;
  EXPECT_TRUE(door.is_door);
  EXPECT_NEAR(door.width_m(), 0.9, 0.15);
  EXPECT_NEAR(0.5f * (door.left_map + door.right_map).x(), 0.0, 0.15);
  EXPECT_GT(result.vertices.size(), 4u);
}

TEST(FreeSpaceMapperTest, IdleRoundChangesNothingButItsNumber) {
  FreeSpaceMapper mapper{FreeSpaceConfig{}};
  walk(mapper);
  MapUpdate idle;
  idle.round = 9;
  idle.idle = true;
  const auto vertices = mapper.step(std::nullopt, idle).vertices.size();
  idle.round = 10;
  const FreeSpace& after = mapper.step(std::nullopt, idle);
  EXPECT_EQ(after.round, 10);
  EXPECT_EQ(after.vertices.size(), vertices);
}

}  // namespace
}  // namespace sgraphs
