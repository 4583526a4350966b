#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "backend/graph/situational_graph.h"

namespace sgraphs {

struct MapPoint {
  Eigen::Vector3f position_map = Eigen::Vector3f::Zero();  // [m]
  FloorId floor;
  int64_t weight = 0;  // raw points behind it
};

// The storey a keyframe stands on; f0 where no storeys were told apart.
FloorId floorOf(const KeyframeNode& node);

// All keyframes' points in map, one centroid per voxel and storey, weighted by the raw points behind each;
// ordered by storey and voxel. No point is dropped for disagreeing with others.
std::vector<MapPoint> buildMap(const SituationalGraph& graph, double voxel_m);

}  // namespace sgraphs
