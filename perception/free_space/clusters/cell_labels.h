#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "perception/free_space/storey_grid.h"

namespace sgraphs {

// Which region each cell of a grid belongs to, row-major like the grid.
using CellLabels = std::vector<int32_t>;
constexpr int32_t kNoLabel = -1;

struct CellStep {
  int x, y;
};
// The four sides first.
constexpr std::array<CellStep, 8> kCellSteps{
    {{1, 0}, {0, 1}, {-1, 0}, {0, -1}, {1, 1}, {-1, 1}, {-1, -1}, {1, -1}}};

// A straight line across free space, from obstacle to obstacle.
struct Cut {
  Eigen::Vector2d left = Eigen::Vector2d::Zero();
  Eigen::Vector2d right = Eigen::Vector2d::Zero();
  bool narrows = true;  // free space is narrower here than on either side

  Eigen::Vector2d middle() const { return 0.5 * (left + right); }
  double width() const { return (right - left).norm(); }
};

// Grids have less than 2^32 cells.
inline int cellX(const StoreyGrid& grid, size_t index) {
  return static_cast<int>(static_cast<uint32_t>(index) % static_cast<uint32_t>(grid.width));
}
inline int cellY(const StoreyGrid& grid, size_t index) {
  return static_cast<int>(static_cast<uint32_t>(index) / static_cast<uint32_t>(grid.width));
}
inline Eigen::Vector2d centerOf(const StoreyGrid& grid, size_t index) {
  return grid.center(cellX(grid, index), cellY(grid, index));
}
// The cell that holds a place; it may lie outside of the grid.
inline CellStep cellAt(const StoreyGrid& grid, const Eigen::Vector2d& p) {
  const Eigen::Vector2d cell = ((p - grid.origin_map) / grid.cell_m).array().floor();
  return {static_cast<int>(cell.x()), static_cast<int>(cell.y())};
}
inline int32_t labelAt(const StoreyGrid& grid, const CellLabels& labels, const Eigen::Vector2d& p) {
  const CellStep cell = cellAt(grid, p);
  return grid.contains(cell.x, cell.y) ? labels[grid.index(cell.x, cell.y)] : kNoLabel;
}

// Cells outside of the grid are unknown.
inline CellState stateAt(const StoreyGrid& grid, int x, int y) {
  return grid.contains(x, y) ? grid.state[grid.index(x, y)] : CellState::kUnknown;
}

}  // namespace sgraphs
