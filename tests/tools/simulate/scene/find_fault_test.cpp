#include "tools/simulate/scene/find_fault.h"

#include <gtest/gtest.h>

#include "tools/simulate/scene/test_worlds.h"

namespace sgraphs::simulate {
namespace {

TEST(FindFaultTest, GoodSceneHasNone) {
  EXPECT_EQ(findFault(makeBoxRoom(4, 4)), std::nullopt);
}

TEST(FindFaultTest, WalkThroughClosedWallIsNamedAndThroughDoorwayIsNot) {
  Scene scene = makeBoxRoom(6, 4);
  scene.walls.push_back({{3, 0}, {3, 4}, 0.1, 0, 2.8});
  scene.path.waypoints = {{{1, 2}, 0}, {{5, 2}, 0}};
  const auto fault = findFault(scene);
  ASSERT_TRUE(fault.has_value());
  EXPECT_NE(fault->find("walls[4]"), std::string::npos) << *fault;
  EXPECT_NE(fault->find("waypoints[0]"), std::string::npos) << *fault;
  scene.doorways.push_back({0, {3, 2, 0}, 0.95, 2.1});
  EXPECT_EQ(findFault(scene), std::nullopt);
  scene.doorways[0].height_m = 0.6;  // a hatch that the body does not fit through
  EXPECT_NE(findFault(scene), std::nullopt);
}

TEST(FindFaultTest, RoundedCornerThatBrushesFurnitureIsFound) {
  Scene scene = makeBoxRoom(8, 8);
  scene.path.turn_radius_m = 3;
  scene.path.waypoints = {{{1, 1}, 0}, {{7, 1}, 0}, {{7, 7}, 0}};
  ASSERT_EQ(findFault(scene), std::nullopt);
  // Clear of both legs by more than the clearance, and under the arc that joins them.
  scene.boxes.push_back({"lamp", {6.55, 1.45}, {0.2, 0.2}, 0, 1.5, 0});
  const auto fault = findFault(scene);
  ASSERT_TRUE(fault.has_value());
  EXPECT_NE(fault->find("rounds corners"), std::string::npos) << *fault;
  EXPECT_NE(fault->find("'lamp'"), std::string::npos) << *fault;
}

}  // namespace
}  // namespace sgraphs::simulate
