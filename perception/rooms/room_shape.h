#pragma once

#include <optional>
#include <vector>

#include "common/types/rooms.h"
#include "perception/rooms/cluster_border.h"
#include "perception/rooms/rooms_config.h"
#include "perception/rooms/wall_candidates.h"
#include "perception/rooms/wall_map.h"

namespace sgraphs {

// A room as one cluster and its walls show it.
struct RoomShape {
  RoomKind kind = RoomKind::kPolygon;
  std::vector<RoomCorner> corners;
  Polygon2d polygon;  // the same without walls
  double area_m2 = 0;
  std::vector<std::pair<PlaneId, PlaneId>> pairs;
  Eigen::Vector2d center_map = Eigen::Vector2d::Zero();
  Eigen::Vector2d free_center_map = Eigen::Vector2d::Zero();

  std::vector<PlaneId> walls() const;  // of the outline, ascending
};

// Two opposed walls: the points between them at the same distance from both.
struct MidPlane {
  Eigen::Vector2d normal;  // unit
  double d = 0;

  MidPlane(const Wall& a, const Wall& b);
};

// Where two mid-planes meet; they are not parallel.
Eigen::Vector2d intersection(const MidPlane& a, const MidPlane& b);

// The room of a cluster; none if the evidence is not good enough: too little of it was seen, it is too small,
// or it is not closed by walls. `walls`: all of the storey that may be near.
std::optional<RoomShape> roomShapeOf(const FreeSpaceCluster& cluster, const std::vector<Wall>& walls,
                                     const RoomsConfig& config);

}  // namespace sgraphs
