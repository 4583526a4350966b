#include "perception/free_space/clusters/passable.h"

#include <algorithm>
#include <cmath>

#include "perception/free_space/clusters/cell_labels.h"

namespace sgraphs {
namespace {

constexpr double kGap_m = 0.3;    // what a narrow robot needs, less a cell
constexpr double kDepth_m = 0.2;  // a wall's own cells lie so far before and behind the narrowest place

bool blocks(const StoreyGrid& grid, const Eigen::Vector2d& p_map) {
  const CellStep cell = cellAt(grid, p_map);
  return stateAt(grid, cell.x, cell.y) == CellState::kObstacle;
}

// The longest stretch from a to b that nothing blocks [m].
double longestGap(const StoreyGrid& grid, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const double step_m = 0.5 * grid.cell_m;
  const int steps = std::max(1, static_cast<int>(std::lround((b - a).norm() / step_m)));
  double gap_m = 0, longest_m = 0;
  for (int i = 0; i <= steps; ++i) {
    gap_m = blocks(grid, a + (b - a) * i / steps) ? 0 : gap_m + step_m;
    longest_m = std::max(longest_m, gap_m);
  }
  return longest_m;
}

}  // namespace

bool isPassable(const StoreyGrid& navigation, const Eigen::Vector2d& left, const Eigen::Vector2d& right) {
  const Eigen::Vector2d along = (right - left).normalized();
  const Eigen::Vector2d across(-along.y(), along.x());
  const int rows = static_cast<int>(std::lround(kDepth_m / navigation.cell_m));
  for (int row = -rows; row <= rows; ++row) {
    const Eigen::Vector2d offset = row * navigation.cell_m * across;
    if (longestGap(navigation, left + offset, right + offset) < kGap_m) return false;
  }
  return true;
}

}  // namespace sgraphs
