#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "perception/free_space/storey_grid.h"
#include "tools/simulate/scene/scene.h"

namespace sgraphs {

// How a building becomes grids.
struct PlanView {
  int floor = 0;
  double yaw_rad = 0;  // of the building in map
  double cell_m = 0.1;
  double noise = 0.12;  // share of the cells at walls that are wrong by one
  uint32_t seed = 1;
  double reach_m = 5.0;  // of the clearance
  // What has been seen of the building, by place in the building's frame; all where empty.
  std::function<bool(const Eigen::Vector2d&)> seen;
};

// What a storey's sensors would have found: cells that hold a face of a wall are obstacles, what is within
// walls and outside of rooms is unknown.
struct PlanGrids {
  StoreyGrid rooms;       // walls only
  StoreyGrid navigation;  // with furniture and columns
};

simulate::Scene shippedScene(const std::string& name);
PlanGrids planGrids(const simulate::Scene& scene, const PlanView& view);

// From centre to centre, exact, by two passes of lower envelopes.
void fillClearance(StoreyGrid& grid, double reach_m);

// Grid from rows of text, the last row at y = 0: '.' free, '#' obstacle, anything else unknown; each letter
// stands for `repeat` x `repeat` cells.
StoreyGrid gridOf(const std::vector<std::string>& rows, int repeat = 1);

Eigen::Vector2d toMap(const Eigen::Vector2d& p_building, double yaw_rad);

}  // namespace sgraphs
