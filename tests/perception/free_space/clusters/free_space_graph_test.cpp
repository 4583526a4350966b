#include "perception/free_space/clusters/free_space_graph.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "common/geometry/convex_polygon.h"
#include "tests/perception/free_space/clusters/clusters_truth.h"

namespace sgraphs {
namespace {

constexpr int kCells = 10;  // a letter of a drawing is a square of a metre

// Two rooms of 5 x 5 m with a door of a metre between them.
const std::vector<std::string> kTwoRooms = {"#############",  //
                                            "#.....#.....#",  //
                                            "#.....#.....#",  //
                                            "#...........#",  //
                                            "#.....#.....#",  //
                                            "#.....#.....#",  //
                                            "#############"};

const FreeSpaceCluster* clusterAt(const FreeSpace& space, const Eigen::Vector2f& p) {
  for (const auto& [id, cluster] : space.clusters) {
    bool in = false;
    const auto& b = cluster.border;
    for (size_t i = 0, j = b.size() - 1; i < b.size(); j = i++) {
      const Eigen::Vector2f &u = b[i].position_map, &v = b[j].position_map;
      if ((u.y() > p.y()) != (v.y() > p.y()) &&
          p.x() < (v.x() - u.x()) * (p.y() - u.y()) / (v.y() - u.y()) + u.x())
        in = !in;
    }
    if (in) return &cluster;
  }
  return nullptr;
}

TEST(FreeSpaceGraphTest, TwoRoomsWithTheirDoor) {
  const StoreyGrid grid = gridOf(kTwoRooms, kCells);
  FreeSpaceGraph graph{FreeSpaceGraphConfig{}};
  graph.update(grid, grid);
  ASSERT_EQ(graph.result().clusters.size(), 2U);
  for (const auto& [id, cluster] : graph.result().clusters) {
    EXPECT_NEAR(cluster.area_m2, 25.5, 1.0);
    EXPECT_NEAR(cluster.max_clearance_m, 2.55, 0.15);
    EXPECT_FALSE(cluster.is_corridor);
  }
  ASSERT_EQ(graph.result().passages.size(), 1U);
  const Passage& door = graph.result().passages.begin()->second;
  EXPECT_TRUE(door.is_door);
  EXPECT_LT(door.a, door.b);
  EXPECT_NEAR(door.width_m(), 1.0, 0.11);
  EXPECT_NEAR(door.left_map.x(), 6.5, 0.6);
  // From the western room into the eastern one, left is north.
  const bool eastward = graph.result().clusters.at(door.a).center_map.x() < 6;
  EXPECT_EQ(door.left_map.y() > door.right_map.y(), eastward);
}

TEST(FreeSpaceGraphTest, BordersAreSimpleCounterClockwiseAndSayWhatIsBehind) {
  StoreyGrid grid = gridOf(kTwoRooms, kCells);
  // Nobody has seen the eastern wall.
  for (int y = 0; y < grid.height; ++y)
    for (int x = 105; x < grid.width; ++x) grid.state[grid.index(x, y)] = CellState::kUnknown;
  fillClearance(grid, 5);
  FreeSpaceGraph graph{FreeSpaceGraphConfig{}};
  graph.update(grid, grid);
  const FreeSpaceCluster* east = clusterAt(graph.result(), {9, 3});
  ASSERT_NE(east, nullptr);
  ASSERT_LE(east->border.size(), 64U);
  Polygon2d polygon;
  double length_m[3] = {0, 0, 0};
  for (size_t i = 0; i < east->border.size(); ++i) {
    const auto &a = east->border[i], &b = east->border[(i + 1) % east->border.size()];
    polygon.push_back(a.position_map.cast<double>());
    length_m[static_cast<size_t>(a.kind)] += (b.position_map - a.position_map).norm();
  }
  EXPECT_NEAR(polygonArea(polygon), east->area_m2, 0.3);
  EXPECT_NEAR(length_m[static_cast<size_t>(BorderKind::kPassage)], 1.0, 0.3);
  EXPECT_NEAR(length_m[static_cast<size_t>(BorderKind::kFrontier)], 5.0, 0.5);
  EXPECT_NEAR(length_m[static_cast<size_t>(BorderKind::kObstacle)], 11.8, 1.5);
}

TEST(FreeSpaceGraphTest, ASecondUpdateKeepsAllIds) {
  const StoreyGrid grid = gridOf(kTwoRooms, kCells);
  FreeSpaceGraph graph{FreeSpaceGraphConfig{}};
  graph.update(grid, grid);
  const FreeSpace first = graph.result();
  graph.update(grid, grid);
  const auto ids = [](const auto& map) {
    std::vector<int64_t> list;
    list.reserve(map.size());
    for (const auto& [id, item] : map) list.push_back(id.value);
    return list;
  };
  EXPECT_EQ(ids(graph.result().clusters), ids(first.clusters));
  EXPECT_EQ(ids(graph.result().passages), ids(first.passages));
  EXPECT_EQ(ids(graph.result().vertices), ids(first.vertices));
}

TEST(FreeSpaceGraphTest, IdsStayWhenTheGridGrows) {
  FreeSpaceGraph graph{FreeSpaceGraphConfig{}};
  const StoreyGrid small = gridOf(kTwoRooms, kCells);
  graph.update(small, small);
  const ClusterId west = clusterAt(graph.result(), {3, 3})->id;
  std::vector<std::string> rows = kTwoRooms;
  for (std::string& row : rows) row = "  " + row;
  StoreyGrid large = gridOf(rows, kCells);
  large.origin_map.x() = -2;
  graph.update(large, large);
  ASSERT_NE(clusterAt(graph.result(), {3, 3}), nullptr);
  EXPECT_EQ(clusterAt(graph.result(), {3, 3})->id, west);
}

TEST(FreeSpaceGraphTest, MergedRoomsTakeTheLowestIdAndASplitGivesANewOne) {
  std::vector<std::string> open = kTwoRooms;
  for (size_t k = 1; k < 6; ++k) open[k][6] = '.';
  const StoreyGrid two = gridOf(kTwoRooms, kCells), one = gridOf(open, kCells);
  FreeSpaceGraph graph{FreeSpaceGraphConfig{}};
  graph.update(two, two);
  const auto lowest = graph.result().clusters.begin()->first,
             highest = graph.result().clusters.rbegin()->first;
  graph.update(one, one);
  ASSERT_EQ(graph.result().clusters.size(), 1U);
  EXPECT_EQ(graph.result().clusters.begin()->first, lowest);
  EXPECT_TRUE(graph.result().passages.empty());
  graph.update(two, two);
  ASSERT_EQ(graph.result().clusters.size(), 2U);
  EXPECT_EQ(graph.result().clusters.begin()->first, lowest);
  EXPECT_GT(graph.result().clusters.rbegin()->first, highest);  // never used again
}

TEST(FreeSpaceGraphTest, ADoorwayIsRememberedWhileSomebodyStandsInIt) {
  const StoreyGrid open = gridOf(kTwoRooms, kCells);
  StoreyGrid blocked = open;
  for (int y = 28; y < 42; ++y)
    for (int x = 63; x < 67; ++x) blocked.state[blocked.index(x, y)] = CellState::kObstacle;
  fillClearance(blocked, 5);
  FreeSpaceGraph graph{FreeSpaceGraphConfig{}};
  graph.update(open, open);
  graph.update(blocked, blocked);
  EXPECT_TRUE(graph.result().passages.empty()) << "seen once: it may have been a wall half seen";
  for (int call = 0; call < 10; ++call) graph.update(open, open);
  const auto door = graph.result().passages.begin()->first;
  graph.update(blocked, blocked);
  ASSERT_EQ(graph.result().passages.size(), 1U);
  EXPECT_EQ(graph.result().passages.begin()->first, door);
  graph.update(open, open);
  ASSERT_EQ(graph.result().passages.size(), 1U);
  EXPECT_EQ(graph.result().passages.begin()->first, door);
}

TEST(FreeSpaceGraphTest, WhatNobodyCanWalkThroughIsAPassageButNoDoor) {
  const StoreyGrid rooms = gridOf(kTwoRooms, kCells);
  const auto doorWithSill = [&rooms](int y_end) {
    StoreyGrid navigation = rooms;
    for (int y = 28; y < y_end; ++y) navigation.state[navigation.index(65, y)] = CellState::kObstacle;
    fillClearance(navigation, 5);
    FreeSpaceGraph graph{FreeSpaceGraphConfig{}};
    graph.update(rooms, navigation);
    EXPECT_EQ(graph.result().passages.size(), 1U);
    return graph.result().passages.begin()->second.is_door;
  };
  EXPECT_FALSE(doorWithSill(42)) << "a window has a sill";
  EXPECT_TRUE(doorWithSill(35)) << "a box leaves half of the door";
}

TEST(FreeSpaceGraphTest, StoreysDoNotShareIds) {
  StoreyGrid lower = gridOf(kTwoRooms, kCells), upper = lower;
  upper.floor = FloorId{1};
  upper.surface_z_m = 3;
  FreeSpaceGraph graph{FreeSpaceGraphConfig{}};
  graph.update(lower, lower);
  graph.update(upper, upper);
  EXPECT_EQ(graph.result().clusters.size(), 4U);
  EXPECT_EQ(graph.result().passages.size(), 2U);
  EXPECT_FLOAT_EQ(graph.result().passages.rbegin()->second.z_m, 3);
  EXPECT_FLOAT_EQ(graph.result().vertices.rbegin()->second.position_map.z(), 3);
}

// Distance of a place to the nearest cell that is not free, by looking at all of them.
double clearanceAt(const StoreyGrid& grid, const Eigen::Vector2d& p) {
  const CellStep at = cellAt(grid, p);
  double best_m = 1e9;
  for (int y = at.y - 5; y <= at.y + 5; ++y)
    for (int x = at.x - 5; x <= at.x + 5; ++x)
      if (stateAt(grid, x, y) != CellState::kFree) best_m = std::min(best_m, (grid.center(x, y) - p).norm());
  return best_m;
}

TEST(FreeSpaceGraphTest, EdgesKeepTheirClearanceAndJoinAllRooms) {
  PlanView view;
  view.yaw_rad = 0.4;
  const PlanGrids grids = planGrids(shippedScene("se1"), view);
  const FreeSpaceGraphConfig config;
  FreeSpaceGraph graph{config};
  graph.update(grids.rooms, grids.navigation);
  const auto& vertices = graph.result().vertices;
  ASSERT_GT(vertices.size(), 100U);
  for (const auto& [id, vertex] : vertices) {
    EXPECT_EQ(vertex.id, id);
    EXPECT_TRUE(std::is_sorted(vertex.neighbours.begin(), vertex.neighbours.end()));
    for (const VertexId next : vertex.neighbours) {
      const FreeSpaceVertex& other = vertices.at(next);
      EXPECT_THAT(other.neighbours, testing::Contains(id));
      const Eigen::Vector2d a = vertex.position_map.head<2>().cast<double>();
      const Eigen::Vector2d b = other.position_map.head<2>().cast<double>();
      EXPECT_LT((b - a).norm(), 1.5);
      for (double s = 0; s <= 1; s += 0.1)
        ASSERT_GE(clearanceAt(grids.navigation, a + s * (b - a)), config.edge_clearance_m - 1e-6);
    }
  }
  // All is reached from the first vertex, but for corners behind furniture.
  std::set<VertexId> reached{vertices.begin()->first};
  std::vector<VertexId> open{vertices.begin()->first};
  while (!open.empty()) {
    const VertexId at = open.back();
    open.pop_back();
    for (const VertexId next : vertices.at(at).neighbours)
      if (reached.insert(next).second) open.push_back(next);
  }
  std::set<ClusterId> clusters;
  for (const VertexId id : reached) clusters.insert(vertices.at(id).cluster);
  EXPECT_GE(clusters.size(), graph.result().clusters.size());
  EXPECT_GT(reached.size(), 0.9 * static_cast<double>(vertices.size()));
}

TEST(FreeSpaceGraphTest, EveryDoorHasAVertex) {
  const StoreyGrid grid = gridOf(kTwoRooms, kCells);
  FreeSpaceGraph graph{FreeSpaceGraphConfig{}};
  graph.update(grid, grid);
  const Passage& door = graph.result().passages.begin()->second;
  const Eigen::Vector2f middle = 0.5F * (door.left_map + door.right_map);
  EXPECT_TRUE(std::any_of(graph.result().vertices.begin(), graph.result().vertices.end(),
                          [&middle](const auto& entry) {
                            return (entry.second.position_map.template head<2>() - middle).norm() < 0.3F;
                          }));
}

// What lies within 5 m of the path walked so far is known.
TEST(FreeSpaceGraphTest, RoomsKeepTheirIdsWhileTheKnownPartGrows) {
  const simulate::Scene scene = shippedScene("se1");
  FreeSpaceGraph graph{FreeSpaceGraphConfig{}};
  std::map<std::string, ClusterId> id_of;
  int changes = 0, kept = 0;
  for (size_t steps = 2; steps <= scene.path.waypoints.size(); steps += 2) {
    PlanView view;
    view.yaw_rad = 0.5;
    view.seed = static_cast<uint32_t>(steps);
    view.seen = [&](const Eigen::Vector2d& p) {
      for (size_t k = 0; k + 1 < steps; ++k)
        if (distanceToSegment(p, scene.path.waypoints[k].xy, scene.path.waypoints[k + 1].xy) < 5.0)
          return true;
      return false;
    };
    const PlanGrids grids = planGrids(scene, view);
    graph.update(grids.rooms, grids.navigation);
    for (const auto& room : scene.rooms) {
      const Eigen::Vector2d center = polygonCentroid(room.polygon);
      const FreeSpaceCluster* cluster = clusterAt(graph.result(), toMap(center, view.yaw_rad).cast<float>());
      if (!cluster || cluster->area_m2 < 0.8 * polygonArea(room.polygon)) continue;
      const auto [it, is_new] = id_of.emplace(room.id, cluster->id);
      if (!is_new) (it->second == cluster->id ? kept : changes) += 1;
      it->second = cluster->id;
    }
  }
  EXPECT_EQ(changes, 0);
  EXPECT_GT(kept, 20);
  EXPECT_GE(id_of.size(), 8U);
}

}  // namespace
}  // namespace sgraphs
