#pragma once

#include <span>
#include <string>
#include <vector>

#include "backend/graph/situational_graph.h"
#include "backend/output/map_cloud.h"
#include "common/io/canvas.h"

namespace sgraphs {

// Heights over the walking surface that a plan shows: walls and furniture, not floor and ceiling.
inline constexpr double kPlanSliceLow_m = 0.25;
inline constexpr double kPlanSliceHigh_m = 2.0;

// What one storey's plan shows, in map, metres: how much stands above each cell of ground, and the path.
struct FloorPlan {
  FloorId floor;
  bool height_known = true;  // false: only a lift led here
  Raster ink;                // grey: the share of the height slice that holds points
  struct PathPoint {
    Eigen::Vector2d position_map;
    double time_s = 0;   // since the run's first scan
    bool joined = true;  // with the point before; false where the robot was on another storey in between
  };
  std::vector<PathPoint> path;
  // A stretch of a wall's face, seen from above; the face looks to the left of a -> b.
  struct WallLine {
    PlaneId wall;
    Eigen::Vector2d a = Eigen::Vector2d::Zero();
    Eigen::Vector2d b = Eigen::Vector2d::Zero();
  };
  std::vector<WallLine> walls;
  struct Room {
    RoomId id;
    std::vector<Eigen::Vector2d> polygon;
    Eigen::Vector2d label_at = Eigen::Vector2d::Zero();  // far from every wall
    double room_for_label_m = 0;                         // free around it
    double area_m2 = 0;
    bool corridor = false;
  };
  std::vector<Room> rooms;
  // Seen from above, jamb to jamb.
  struct Door {
    Eigen::Vector2d left = Eigen::Vector2d::Zero();
    Eigen::Vector2d right = Eigen::Vector2d::Zero();
    double width_m = 0;
  };
  std::vector<Door> doors;
  double duration_s = 0;  // of the whole run: the colour scale's end
  Paper extent;           // of ink and path
};

FloorPlan makeFloorPlan(const SituationalGraph& graph, const FloorNode& floor, std::span<const MapPoint> map,
                        std::span<const OdometryEstimate> scans);

// Faces of the storey's walls where their extent reaches into the slice, by id; a doorway leaves a gap.
std::vector<FloorPlan::WallLine> wallLines(const SituationalGraph& graph, const FloorNode& floor);

// Rooms and doorways of the storey, by id.
std::vector<FloorPlan::Room> planRooms(const SituationalGraph& graph, FloorId floor);
std::vector<FloorPlan::Door> planDoors(const SituationalGraph& graph, FloorId floor);

std::string floorPlanPng(const FloorPlan& plan);
std::string floorPlanSvg(const FloorPlan& plan);

}  // namespace sgraphs
