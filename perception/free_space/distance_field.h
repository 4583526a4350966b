#pragma once

#include "perception/free_space/cell_box.h"
#include "perception/free_space/storey_grid.h"

namespace sgraphs {

// Brings clearance_m up to date after states changed within `changed`: exact Euclidean distances, as if all
// were computed anew, up to reach_m. Beyond the grid nothing is free.
void updateClearance(StoreyGrid& grid, const CellBox& changed, double reach_m);

}  // namespace sgraphs
