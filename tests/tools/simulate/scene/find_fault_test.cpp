#include "tools/simulate/scene/find_fault.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tools/simulate/scene/test_worlds.h"

namespace sgraphs::simulate {
namespace {

using testing::AllOf;
using testing::HasSubstr;

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

// What is said of the scene; one line, or nothing.
std::string fault(const Scene& scene) {
  std::string text = findFault(scene).value_or("");
  EXPECT_EQ(text.find('\n'), std::string::npos) << text;
  return text;
}

TEST(FindFaultTest, EachBadItemIsNamedInOneLine) {
  const Scene good = makeBoxRoom(6, 4);
  Scene scene = good;
  scene.windows.push_back({{3, 2, 1}, 1, 1, false});
  EXPECT_THAT(fault(scene), AllOf(HasSubstr("windows[0]"), HasSubstr("(3, 2)"), HasSubstr("not on a wall")));
  scene.windows[0] = {{3, -0.05, 2.5}, 1, 1, false};
  EXPECT_THAT(fault(scene), HasSubstr("windows[0]"));
  scene.windows[0].height_m = 0;
  EXPECT_THAT(fault(scene), AllOf(HasSubstr("windows[0]"), HasSubstr("positive")));
  scene.windows[0] = {{3, -0.05, 1}, 1, 1, true};
  EXPECT_EQ(fault(scene), "");

  scene = good;
  scene.columns.push_back({"", {1, 1}, 0, 0, 2});
  EXPECT_THAT(fault(scene), AllOf(HasSubstr("columns[0]"), HasSubstr("radius")));
  scene.columns[0] = {"", {1, 1}, 0.2, 2, 2};
  EXPECT_THAT(fault(scene), AllOf(HasSubstr("columns[0]"), HasSubstr("no height")));

  scene = good;
  scene.stairs.push_back({{1, 1}, {1, 1}, 1, 0, 3, 17});
  EXPECT_THAT(fault(scene), AllOf(HasSubstr("stairs[0]"), HasSubstr("no length")));
  scene.stairs[0] = {{1, 1}, {4, 1}, 1, 0, 3, 0};
  EXPECT_THAT(fault(scene), AllOf(HasSubstr("stairs[0]"), HasSubstr("0 steps")));
  scene.stairs[0] = {{1, 1}, {4, 1}, 0, 0, 3, 9};
  EXPECT_THAT(fault(scene), AllOf(HasSubstr("stairs[0]"), HasSubstr("width")));
  scene.stairs[0] = {{1, 1}, {4, 1}, 1, 3, 0, 9};
  EXPECT_THAT(fault(scene), AllOf(HasSubstr("stairs[0]"), HasSubstr("no height")));

  scene = good;
  scene.people.emplace_back();
  EXPECT_THAT(fault(scene), AllOf(HasSubstr("people[0]"), HasSubstr("no waypoints")));
  scene.people[0].waypoints = {{1, 1}, {std::nan(""), 1}};
  EXPECT_THAT(fault(scene), AllOf(HasSubstr("people[0].waypoints[1]"), HasSubstr("finite")));
  scene.people[0].waypoints = {{1, 1}, {1, 1}};
  EXPECT_THAT(fault(scene), AllOf(HasSubstr("people[0].waypoints[1]"), HasSubstr("same")));
  scene.people[0].waypoints = {{1, 1}, {9, 1}};  // through walls, as people in a plan may
  EXPECT_EQ(fault(scene), "");
  scene.people[0].speed_mps = 0;
  EXPECT_THAT(fault(scene), AllOf(HasSubstr("people[0]"), HasSubstr("speed")));

  scene = {};
  EXPECT_THAT(fault(scene), HasSubstr("neither a wall"));
}

}  // namespace
}  // namespace sgraphs::simulate
