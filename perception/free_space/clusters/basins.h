#pragma once

#include "perception/free_space/clusters/cell_labels.h"
#include "perception/free_space/clusters/free_space_graph_config.h"

namespace sgraphs {

// Free cells flooded from the widest places down. Where two floods meet, they become one unless the meeting
// place is narrow against the widest place of the smaller of them; so noise of a wall and a room's corners
// make no basins of their own, and a door of 0.8 m into a closet of 1.2 m is found as well as an opening of
// 2.2 m. Labels are 0 … count-1.
CellLabels floodBasins(const StoreyGrid& grid, const FreeSpaceGraphConfig& config, int32_t* count);

}  // namespace sgraphs
