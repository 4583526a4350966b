#pragma once

#include <vector>

#include "perception/free_space/clusters/free_space_graph_config.h"
#include "perception/free_space/clusters/regions.h"

namespace sgraphs {

// Openings that are no narrowing of the clearance, because they are wider than a room behind them is deep:
// where one wall ends and goes on in the same line beyond a gap. The gap must be narrow against both sides,
// measured along the wall. Cuts are left in `regions`; their lines are returned.
std::vector<Cut> cutWallGaps(const StoreyGrid& grid, const FreeSpaceGraphConfig& config,
                             const std::vector<Cut>& former, Regions& regions);

}  // namespace sgraphs
