#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <utility>
#include <vector>

#include "common/base/ids.h"
#include "common/base/time.h"

namespace sgraphs {

enum class RoomKind : int8_t {
  kInfinite = 1,  // one pair of opposed walls: a corridor, or a room whose ends were not seen as walls
  kFinite = 2,    // two pairs of opposed walls
  kPolygon = 3,   // any other closed ring of walls
};

struct RoomCorner {
  Eigen::Vector2d position_map = Eigen::Vector2d::Zero();
  PlaneId wall;  // of the edge from this corner to the next; invalid: no mapped wall stands there
};

// A room as it is seen in the map of a round.
struct RoomObservation {
  RoomId id;  // stable from round to round, never reused
  RoomKind kind = RoomKind::kPolygon;
  FloorId floor;
  Time accepted;  // sensor time at which it was first accepted
  // Along the inner faces of the walls: simple, counter-clockwise, not closed.
  std::vector<RoomCorner> polygon;
  Eigen::Vector2d center_map = Eigen::Vector2d::Zero();
  double area_m2 = 0;
  // Opposed walls that make the room's centre: none (polygon), one (infinite) or two (finite).
  std::vector<std::pair<PlaneId, PlaneId>> pairs;
  // Centre of the free space: an infinite room's place along its walls.
  Eigen::Vector2d free_center_map = Eigen::Vector2d::Zero();
  KeyframeId anchor;  // keyframe nearest to it

  // All walls of polygon and pairs, ascending.
  std::vector<PlaneId> walls() const;
};

// An opening from one room into another.
struct Doorway {
  PassageId id;
  FloorId floor;
  RoomId a, b;                                             // b is invalid where no room is known behind it
  Eigen::Vector3d position_map = Eigen::Vector3d::Zero();  // its middle, on the walking surface
  double width_m = 0;
};

// A storey: its walking surface.
struct FloorObservation {
  FloorId id;
  bool has_height = false;
  double z_m = 0;                                        // of the walking surface in map
  Eigen::Vector2d center_map = Eigen::Vector2d::Zero();  // from the storey's walls
};

struct KeyframeFloor {
  KeyframeId keyframe;
  FloorId floor;  // invalid: between storeys
};

// The upper layers after a round; complete, but for the keyframes' floors, which are those that changed.
struct Rooms {
  int64_t round = -1;  // whose GRAPH_UPDATE they are made of
  Time time;
  std::vector<RoomObservation> rooms;          // by id
  std::vector<Doorway> doorways;               // by id
  std::vector<FloorObservation> floors;        // by id
  std::vector<KeyframeFloor> keyframe_floors;  // by keyframe
};

}  // namespace sgraphs
