#pragma once

#include <map>
#include <set>
#include <span>

#include "backend/graph/situational_graph.h"
#include "backend/output/map_cloud.h"

namespace sgraphs {

// A storey's picture or grid of more cells is not made: an outlier kilometres away must not take the memory.
inline constexpr int kMaxStoreyCells = 100'000'000;

// Every storey that the graph or one of its keyframes names (at least f0), with the height of its walking
// surface: the graph's own where it has one, else measured as the lowest dominant height of map points below
// the path; has_height stays false where no height stands out.
std::map<FloorId, FloorNode> describeFloors(const SituationalGraph& graph, std::span<const MapPoint> map);

// Of these floors those of which FloorNode says that their height is not known.
std::set<FloorId> floorsOfUnknownHeight(const SituationalGraph& graph);

// Heights along `up_map` over the walking surface: what slices of a storey are cut by, also if the map's z is
// not quite vertical. Without a measured surface the path's median height less a legged robot's body height
// stands in for it.
class StoreyHeight {
 public:
  StoreyHeight(const SituationalGraph& graph, const FloorNode& floor);

  double above(const Eigen::Vector3d& p_map) const { return up_.dot(p_map) - surface_; }

 private:
  Eigen::Vector3d up_;
  double surface_ = 0;  // up-component of the walking surface
};

}  // namespace sgraphs
