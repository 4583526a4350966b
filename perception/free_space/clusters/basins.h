#pragma once

#include <vector>

#include "perception/free_space/clusters/cell_labels.h"
#include "perception/free_space/clusters/free_space_graph_config.h"

namespace sgraphs {

// Free cells flooded from the widest places down. Where two floods meet, they become one unless the meeting
// place is narrow against the widest place of the smaller of them; so noise of a wall and a room's corners
// make no basins of their own, and a door of 0.8 m into a closet of 1.2 m is found as well as an opening of
// 2.2 m. `former` are the passages of the round before: there the ratio is a more patient one, so that cuts
// do not come and go. Labels are 0 … count-1.
CellLabels floodBasins(const StoreyGrid& grid, const FreeSpaceGraphConfig& config,
                       const std::vector<Cut>& former, int* count);

// Whether a passage with this clearance lies between two sides of which the smaller has this widest
// clearance.
bool isNarrow(const FreeSpaceGraphConfig& config, double cell_m, double passage_clearance_m,
              double side_clearance_m, bool was_cut);

}  // namespace sgraphs
