#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "backend/graph/situational_graph.h"

namespace sgraphs {

enum class Occupancy : uint8_t { kUnknown, kFree, kOccupied };

// Cells in map, row-major, the first row at the smallest y.
struct OccupancyGrid {
  Eigen::Vector2d origin_map = Eigen::Vector2d::Zero();  // corner of smallest x and y
  double resolution_m = 0.05;
  int width = 0;
  int height = 0;
  std::vector<Occupancy> cells;

  Occupancy at(const Eigen::Vector2d& p_map) const;  // kUnknown outside
};

// What a robot on this storey can run into: rays from each point's own viewpoint clear the cells they cross
// between 0.3 m and 1.8 m over the floor, and occupy the cell they end in if they end in that band. Cells
// weigh hits against later rays that pass, once per keyframe, so that people who walked by leave no wall.
OccupancyGrid buildOccupancy(const SituationalGraph& graph, const FloorNode& floor, double resolution_m);

// The map_server pair: PGM (P5; 0 occupied, 254 free, 205 unknown; first row at the largest y) and its YAML.
std::string occupancyPgm(const OccupancyGrid& grid);
std::string occupancyYaml(const OccupancyGrid& grid, const std::string& image_name);

}  // namespace sgraphs
