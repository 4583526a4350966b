#pragma once

#include <set>
#include <vector>

#include "backend/graph/situational_graph.h"
#include "backend/output/map_cloud.h"
#include "perception/free_space/free_space_evidence.h"

namespace sgraphs {

// What was there for a moment only, people walking above all: places where something was seen, and through
// which rays of at least three keyframes passed, more than three for each keyframe that saw it (0.1 m wide,
// 0.25 m high, from 0.1 to 2.1 m over the walking surface). How well a point agrees with others plays no part
// in it. A pane between rooms goes, too, as most rays pass it; one in an outer wall, behind which nothing
// sends a ray back, stays.
class MovedAway {
 public:
  explicit MovedAway(const SituationalGraph& graph);

  void dropFrom(std::vector<MapPoint>& map) const;

  // Walls that somebody who walked past was taken for: seen from at most three keyframes, and most of what
  // was seen of them has moved away. A wall that a room is made of is none.
  std::set<PlaneId> whoWalkedPast(const SituationalGraph& graph) const;

 private:
  enum class Place { kUnknown, kStands, kMovedAway };

  Place at(const Eigen::Vector3d& p_map, FloorId floor) const;
  bool walkedPast(const PlaneNode& plane) const;

  FreeSpaceEvidence evidence_;
};

}  // namespace sgraphs
