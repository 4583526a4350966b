#include "tools/simulate/scene/find_walk_fault.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tools/simulate/scene/test_worlds.h"

namespace sgraphs::simulate {
namespace {

using testing::AllOf;
using testing::HasSubstr;

std::string walkFault(const Scene& scene) {
  std::string text = findWalkFault(scene).value_or("");
  EXPECT_EQ(text.find('\n'), std::string::npos) << text;
  return text;
}

Scene walkAcross(Scene scene) {
  scene.path.waypoints = {{{1, 2}, 0}, {{5, 2}, 0}};
  return scene;
}

TEST(FindWalkFaultTest, ColumnsGlassAndGlazedWindowsStandInTheWay) {
  const Scene good = walkAcross(makeBoxRoom(6, 4));
  EXPECT_EQ(walkFault(good), "");
  Scene scene = good;
  scene.columns.push_back({"pillar", {3, 2.6}, 0.35, 0, 2.8});
  EXPECT_THAT(walkFault(scene), AllOf(HasSubstr("columns[0] 'pillar'"), HasSubstr("m from")));
  scene.columns[0].center.y() = 2.66;
  EXPECT_EQ(walkFault(scene), "");

  scene = good;
  scene.walls.push_back({{3, 0}, {3, 4}, 0.1, 0, 2.8, true});
  EXPECT_THAT(walkFault(scene), HasSubstr("walls[4]"));
  scene.doorways.push_back({0, {3, 2, 0}, 0.95, 2.1});
  EXPECT_EQ(walkFault(scene), "");

  // A gap down to the floor may be walked through, but not once it is glazed, nor over a sill.
  scene = good;
  scene.walls.push_back({{3, 0}, {3, 4}, 0.1, 0, 2.8});
  scene.windows.push_back({{3, 2, 0}, 1.2, 2.1, false});
  EXPECT_EQ(walkFault(scene), "");
  scene.windows[0].glazed = true;
  EXPECT_THAT(walkFault(scene), HasSubstr("walls[4]"));
  scene.windows[0] = {{3, 2, 0.3}, 1.2, 2.1, false};
  EXPECT_THAT(walkFault(scene), HasSubstr("walls[4]"));
}

TEST(FindWalkFaultTest, StairsAreClimbedAndNotWalkedThrough) {
  const Scene good = makeTwoStoreys();
  EXPECT_EQ(walkFault(good), "");
  // The same way without heights runs into the steps; beside the flight there is room.
  Scene scene = good;
  for (Waypoint& waypoint : scene.path.waypoints) waypoint.rise_m = 0;
  EXPECT_THAT(walkFault(scene), HasSubstr("stairs[0]"));
  scene.path.waypoints = {{{1, 2.0}, 0}, {{7, 2.0}, 0}};
  EXPECT_EQ(walkFault(scene), "");
  scene.path.waypoints = {{{1, 1.8}, 0}, {{7, 1.8}, 0}};
  EXPECT_THAT(walkFault(scene), HasSubstr("stairs[0]"));
  // Down again is as good as up.
  scene = good;
  std::reverse(scene.path.waypoints.begin(), scene.path.waypoints.end());
  EXPECT_EQ(walkFault(scene), "");
}

TEST(FindWalkFaultTest, SlabsThatCloseTheStairwellAreFound) {
  Scene scene = makeTwoStoreys();
  scene.slabs = {{{0, 0}, {9, 5}, -0.1, 0}, {{0, 0}, {9, 5}, 2.9, 3.0}};
  EXPECT_THAT(walkFault(scene), HasSubstr("slabs[1]"));
}

TEST(FindWalkFaultTest, WallsOfTheOtherStoreyAreCheckedAtItsHeight) {
  Scene scene = makeTwoStoreys();
  scene.walls.push_back({{7, 2.4}, {9, 2.4}, 0.1, 0, 2.8});  // under the way
  EXPECT_EQ(walkFault(scene), "");
  scene.walls.back() = {{7, 2.4}, {9, 2.4}, 0.1, 3, 5.8};
  EXPECT_THAT(walkFault(scene), HasSubstr("walls[8]"));
  scene.doorways.push_back({0, {7.8, 2.4, 0}, 0.95, 2.1});  // no door in that wall: its height is another
  EXPECT_THAT(walkFault(scene), HasSubstr("walls[8]"));
  scene.doorways[0] = {1, {7.8, 2.4, 3}, 0.95, 2.1};
  EXPECT_EQ(walkFault(scene), "");
}

TEST(FindWalkFaultTest, WaypointsInTheAirAndSlopesTooSteepAreNamed) {
  Scene scene = makeTwoStoreys();
  scene.path.waypoints = {{{3, 3.5}, 0}, {{6, 3.5}, 0, 1.5}};
  EXPECT_THAT(walkFault(scene),
              AllOf(HasSubstr("path.waypoints[1]"), HasSubstr("z = 1.5"), HasSubstr("in the air")));
  scene.boxes.push_back({"stage", {6.5, 3.5}, {2, 2}, 0, 1.5, 0});
  scene.path.waypoints[0].xy = {3, 3.5};
  EXPECT_THAT(walkFault(scene), HasSubstr("'stage'"));  // no ramp leads up
  scene = makeTwoStoreys();
  scene.path.waypoints = {{{3, 3.5}, 0}, {{5, 3.5}, 0, 3}};
  EXPECT_THAT(walkFault(scene), AllOf(HasSubstr("waypoints[0]"), HasSubstr("rises by 3 m over 2 m")));
  scene.path.waypoints = {{{3, 3.5}, 0}, {{5, 3.5}, 0, std::nan("")}};
  EXPECT_THAT(walkFault(scene), AllOf(HasSubstr("waypoints[1]"), HasSubstr("finite")));
}

TEST(FindWalkFaultTest, WalkThroughTheFloorIsFound) {
  Scene scene = makeTwoStoreys();
  scene.path.waypoints = {{{1, 3.5}, 0}, {{8, 3.5}, 0, 3}};
  EXPECT_THAT(walkFault(scene), HasSubstr("slab"));
}

}  // namespace
}  // namespace sgraphs::simulate
