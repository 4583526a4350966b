#include "backend/output/left_out_walls.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <vector>

#include "tests/backend/output/synthetic_planes.h"

namespace sgraphs {
namespace {

using namespace test;

// A wall along x that looks to -y.
PlaneNode wallAt(int64_t id, const Eigen::Vector3d& center, double half_length_m, int64_t observations,
                 double turned_deg = 0) {
  const double angle = turned_deg * M_PI / 180.0;
  PlaneNode wall = rectanglePlane({id}, PlaneLabel::kY, {std::sin(angle), -std::cos(angle), 0}, center,
                                  half_length_m, 1.2);
  wall.num_observations = observations;
  return wall;
}

SituationalGraph graphOf(const std::vector<PlaneNode>& walls) {
  SituationalGraph graph;
  int64_t factor = 0;
  graph.keyframes[{0}].id = {0};
  graph.floors[{0}].id = {0};
  for (const PlaneNode& wall : walls) {
    graph.planes[wall.id] = wall;
    graph.observations.push_back({factor++, {0}, wall.id, {}});
    graph.plane_ups.push_back({factor++, wall.id, false, 0.01});
  }
  return graph;
}

// A glazed wall of 14 m, seen twice together with the panes of its windows: a plane across it, 3.9 degrees
// turned, which the plan showed as a second wall.
TEST(LeftOutWallsTest, WhatLiesAcrossAWallIsACopyOfIt) {
  const PlaneNode wall = wallAt(1, {0, 3, 1.2}, 7, 103), across = wallAt(2, {2, 3.035, 1.2}, 3, 2, 3.9);
  EXPECT_EQ(copiesOfWalls(graphOf({wall, across})), std::set<PlaneId>({{2}}));
  EXPECT_EQ(copiesOfWalls(graphOf({wall, wallAt(2, {2, 3.05, 1.2}, 1, 5)})), std::set<PlaneId>({{2}}));
}

TEST(LeftOutWallsTest, WhatIsAWallOfItsOwnStays) {
  const PlaneNode wall = wallAt(1, {0, 3, 1.2}, 7, 103);
  PlaneNode behind = wallAt(2, {2, 3.12, 1.2}, 3, 2), upstairs = wallAt(3, {2, 3, 1.2}, 3, 2);
  PlaneNode beside = wallAt(4, {8, 3, 1.2}, 2, 2), leaf = wallAt(5, {2, 3, 1.2}, 0.4, 2, 8);
  PlaneNode often = wallAt(6, {2, 3, 1.2}, 3, 103, 3), far_side = wallAt(7, {2, 3.03, 1.2}, 3, 2, 180);
  upstairs.floor = {1};
  for (const PlaneNode& own : {behind, upstairs, beside, leaf, often, far_side})
    EXPECT_TRUE(copiesOfWalls(graphOf({wall, own})).empty()) << own.id.str();
}

TEST(LeftOutWallsTest, AWallOfARoomStays) {
  SituationalGraph graph = graphOf({wallAt(1, {0, 3, 1.2}, 7, 103), wallAt(2, {2, 3.02, 1.2}, 3, 2)});
  graph.rooms[{7}].id = {7};
  graph.rooms[{7}].seen.pairs = {{{2}, {1}}};
  EXPECT_TRUE(copiesOfWalls(graph).empty());
}

// A storey's centre hangs on its outermost walls, and a copy is often farther out than its wall.
TEST(LeftOutWallsTest, AWallOfAStoreysCentreIsNoWallOfARoom) {
  SituationalGraph graph = graphOf({wallAt(1, {0, 3, 1.2}, 7, 103), wallAt(2, {2, 3.02, 1.2}, 3, 2)});
  graph.center_walls.push_back({10, {{}, {0}}, {1}, {2}});
  EXPECT_EQ(copiesOfWalls(graph), std::set<PlaneId>({{2}}));
}

// Of three in a row, each within reach of the next, the one in the middle goes and the third with no wall to
// be a copy of stays.
TEST(LeftOutWallsTest, ACopyHasNoCopies) {
  const SituationalGraph graph = graphOf(
      {wallAt(1, {0, 3, 1.2}, 2, 40), wallAt(2, {0, 3.05, 1.2}, 2, 10), wallAt(3, {0, 3.1, 1.2}, 2, 2)});
  EXPECT_EQ(copiesOfWalls(graph), std::set<PlaneId>({{2}}));
}

TEST(LeftOutWallsTest, WhatIsLeftOutGoesWithAllThatNamesIt) {
  SituationalGraph graph = graphOf({wallAt(1, {0, 3, 1.2}, 2, 40), wallAt(2, {0, 3, 1.2}, 2, 10)});
  graph.merged_planes[{3}] = {2};
  graph.merged_planes[{4}] = {1};
  graph.faces.push_back({9, {1}, {2}, 0.01});
  graph.center_walls.push_back({10, {{}, {0}}, {1}, {2}});
  const SituationalGraph rest = withoutPlanes(graph, {{2}});
  EXPECT_EQ(rest.planes.size(), 1u);
  EXPECT_EQ(rest.observations.size(), 1u);
  EXPECT_EQ(rest.plane_ups.size(), 1u);
  EXPECT_EQ(rest.merged_planes.size(), 1u);
  EXPECT_TRUE(rest.faces.empty());
  EXPECT_TRUE(rest.center_walls.empty());
  EXPECT_NO_THROW(rest.check());
}

}  // namespace
}  // namespace sgraphs
