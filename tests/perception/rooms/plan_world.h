#pragma once

#include <string>
#include <vector>

#include "common/types/free_space.h"
#include "common/types/map_update.h"
#include "common/types/rooms.h"
#include "perception/rooms/simple_polygon.h"
#include "tools/simulate/scene/scene.h"

namespace sgraphs::test {

struct TrueRoom {
  std::string id;
  FloorId floor;
  ClusterId cluster;
  Polygon2d polygon_map;
};

struct TrueDoorway {
  FloorId floor;
  Eigen::Vector2d position_map = Eigen::Vector2d::Zero();
  double width_m = 0;
};

// How the map lies about the building, and what was seen.
struct WorldOptions {
  double heading_rad = 0;  // of the building's x axis in map
  Eigen::Vector2d offset_m = Eigen::Vector2d(3.1, -1.7);
  double cell_m = 0.1;  // of free space
};

// What mapping a building perfectly gives: the outline of each room's free cells, steps and all, with
// furniture cut out; planes on all walls that are not glass, joined over doors and across rooms as a map
// joins them; planes on furniture; one keyframe in each room.
struct PlanWorld {
  FreeSpace free_space;
  MapUpdate update;
  std::vector<TrueRoom> rooms;
  std::vector<TrueDoorway> doorways;
};
PlanWorld worldOf(const simulate::Scene& scene, const WorldOptions& options);
// Of a plan in config/scenes.
PlanWorld worldOf(const std::string& scene, const WorldOptions& options);

// A level rectangle of walls, doors and so on: the scene that tests build by hand.
simulate::Scene sceneOf(const std::vector<std::vector<Eigen::Vector2d>>& rooms,
                        double wall_thickness_m = 0.1);

// An upright plane from a to b, seen from the left of that direction.
MapPlane wallPlane(PlaneId id, const Eigen::Vector2d& a, const Eigen::Vector2d& b, double z_min_m = 0.1,
                   double z_max_m = 2.6);
MapKeyframe keyframeAt(int64_t id, const Eigen::Vector2d& p, double z_m = 0.52);

// A round in which nothing came and nothing moved.
MapUpdate idleRound(int64_t round);

Polygon2d rectangle(double x0, double y0, double x1, double y1);
// A cluster with a border of the test's own making; without kinds, obstacles all around.
FreeSpaceCluster clusterOf(int64_t id, const Polygon2d& border, const std::vector<BorderKind>& kinds = {});

double iou(const Polygon2d& a, const Polygon2d& b);
Polygon2d polygonOf(const RoomObservation& room);

}  // namespace sgraphs::test
