#pragma once

#include <Eigen/Core>
#include <set>
#include <vector>

#include "perception/free_space/clusters/free_space_graph_config.h"
#include "perception/free_space/storey_grid.h"

namespace sgraphs {

// A graph along the medial axis of one grid. Vertices are cells of it.
struct AxisGraph {
  struct Vertex {
    uint32_t cell = 0;
    std::set<size_t> neighbours;  // indices of vertices
  };
  std::vector<Vertex> vertices;
};

// Vertices at the `wanted` places (where the axis is near), at junctions and ends of the axis, and between
// them so that neighbours are at most about the configured spacing apart. Edges follow the axis and are
// certified (keepsClear).
AxisGraph graphAlongAxis(const StoreyGrid& navigation, const std::vector<Eigen::Vector2d>& wanted,
                         const FreeSpaceGraphConfig& config);

// Whether each point of the straight line is at least this far from all that is not free: a lower bound from
// the clearances of the cells around it.
bool keepsClear(const StoreyGrid& grid, const Eigen::Vector2d& a, const Eigen::Vector2d& b,
                double clearance_m);

}  // namespace sgraphs
