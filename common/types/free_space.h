#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <map>
#include <vector>

#include "common/base/ids.h"
#include "common/base/time.h"

namespace sgraphs {

// A place on the medial axis of free space.
struct FreeSpaceVertex {
  VertexId id;
  FloorId floor;
  ClusterId cluster;                                       // invalid: of none (yet)
  Eigen::Vector3f position_map = Eigen::Vector3f::Zero();  // on the walking surface [m]
  float clearance_m = 0;             // distance to the nearest obstacle, seen from above
  std::vector<VertexId> neighbours;  // ascending, both ways; the straight line to each is free of collision
};

// What lies behind the border of a cluster, from one corner to the next.
enum class BorderKind : uint8_t {
  kObstacle = 0,  // something stands there
  kFrontier = 1,  // nobody has looked there yet
  kPassage = 2,   // another cluster
};

struct BorderCorner {
  Eigen::Vector2f position_map = Eigen::Vector2f::Zero();
  BorderKind kind = BorderKind::kObstacle;  // of the edge from this corner to the next
};

// A part of free space that narrows where it meets the next: a room, an arm of a corridor, or a piece of a
// hall.
struct FreeSpaceCluster {
  ClusterId id;
  FloorId floor;
  bool is_corridor = false;  // long and narrow
  float area_m2 = 0;         // of the free cells
  float max_clearance_m = 0;
  Eigen::Vector2f center_map = Eigen::Vector2f::Zero();  // of the widest place
  // Outer border of the free cells: simple, counter-clockwise, not closed; obstacles that stand free inside
  // are not cut out.
  std::vector<BorderCorner> border;
};

// Where two clusters meet: a doorway, or an opening. It is remembered while both live.
struct Passage {
  PassageId id;
  FloorId floor;
  ClusterId a, b;  // a < b
  // Its ends at the narrowest place [m], in map: the jambs.
  Eigen::Vector2f left_map = Eigen::Vector2f::Zero();
  Eigen::Vector2f right_map = Eigen::Vector2f::Zero();
  float z_m = 0;  // of the walking surface, in map
  // A corridor turns here, or one hall was cut where nothing narrows: no doorway.
  bool is_door = true;

  float width_m() const { return (right_map - left_map).norm(); }
};

// The free space of all storeys after a round.
struct FreeSpace {
  int64_t round = -1;  // whose GRAPH_UPDATE it is made of
  Time time;
  std::map<VertexId, FreeSpaceVertex> vertices;
  std::map<ClusterId, FreeSpaceCluster> clusters;
  std::map<PassageId, Passage> passages;
};

}  // namespace sgraphs
