#pragma once

#include <cstdint>
#include <vector>

#include "perception/free_space/cell_box.h"
#include "perception/free_space/storey_grid.h"

namespace sgraphs {

// Which islands (connected cells that are not free, corners count as connected) become free.
struct IslandRule {
  int max_cells = 15;         // extent along x and y
  bool only_unknown = false;  // islands with an obstacle in them stay
};

// Rewrites grid.state from `raw` (same layout) in and around `changed`: small islands in free space become
// free, unless one of their cells is set in `keep` (same layout; may be empty). The result is as if the whole
// grid were filtered anew. Returns the cells whose state differs from before.
CellBox filterIslands(StoreyGrid& grid, const std::vector<CellState>& raw, const std::vector<uint8_t>& keep,
                      const CellBox& changed, const IslandRule& rule);

}  // namespace sgraphs
