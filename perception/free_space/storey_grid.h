#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "common/base/ids.h"

namespace sgraphs {

// Seen from above, between the lowest and the highest obstacle that counts.
enum class CellState : uint8_t { kUnknown, kFree, kObstacle };

// One storey's free space seen from above, row-major, the first row at the smallest y. Cell (x, y) covers
// [origin + (x, y) cell_m, origin + (x + 1, y + 1) cell_m) in map.
struct StoreyGrid {
  FloorId floor;
  double cell_m = 0.1;
  Eigen::Vector2d origin_map = Eigen::Vector2d::Zero();  // a multiple of cell_m
  int width = 0;
  int height = 0;
  std::vector<CellState> state;
  // From the centre of each free cell to the centre of the nearest one that is not [m], at most
  // the configured reach; 0 elsewhere.
  std::vector<float> clearance_m;
  double surface_z_m = 0;  // height of the walking surface in map

  bool contains(int x, int y) const { return x >= 0 && y >= 0 && x < width && y < height; }
  size_t index(int x, int y) const {
    return static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x);
  }
  Eigen::Vector2d center(int x, int y) const {
    return origin_map + cell_m * Eigen::Vector2d(x + 0.5, y + 0.5);
  }
};

}  // namespace sgraphs
