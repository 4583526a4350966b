#pragma once

#include <vector>

#include "common/types/free_space.h"
#include "perception/free_space/clusters/cell_labels.h"

namespace sgraphs {

// A border of a region along the sides of its cells, the region on the left: the outer one runs
// counter-clockwise, those of holes clockwise.
struct CellLoop {
  int32_t label = kNoLabel;
  std::vector<Eigen::Vector2d> corners;  // one per side of a cell [m], in map
  std::vector<BorderKind> kinds;         // what lies across the side from this corner to the next
  double area_m2 = 0;                    // signed: negative for holes
};

// All borders, by the first cell they run below.
std::vector<CellLoop> loopsOf(const StoreyGrid& grid, const CellLabels& labels);

// Corners of a loop that stay when it is drawn with straight lines within a tolerance; ascending indices.
// `fixed` corners stay in any case.
std::vector<size_t> simplifiedLoop(const CellLoop& loop, const std::vector<size_t>& fixed,
                                   double tolerance_m);

// A loop as a cluster's border: simple, at most about `max_corners` corners, corners where the kind changes.
std::vector<BorderCorner> borderOf(const CellLoop& loop, double cell_m, size_t max_corners = 64);

}  // namespace sgraphs
