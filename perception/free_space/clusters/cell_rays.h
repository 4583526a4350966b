#pragma once

#include "perception/free_space/clusters/cell_labels.h"

namespace sgraphs {

// How far one gets from a place in a direction (of length 1) without leaving a region, at most `max_m`; to
// half a cell.
inline double reachWithin(const StoreyGrid& grid, const CellLabels& labels, const Eigen::Vector2d& from,
                          const Eigen::Vector2d& direction, int32_t label, double max_m) {
  const double step_m = 0.5 * grid.cell_m;
  double length_m = 0;
  while (length_m < max_m && labelAt(grid, labels, from + (length_m + step_m) * direction) == label)
    length_m += step_m;
  return length_m;
}

}  // namespace sgraphs
