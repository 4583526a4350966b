#pragma once

#include <vector>

#include "perception/free_space/storey_grid.h"

namespace sgraphs {

// Cells on the medial axis of the free space where the clearance is at least `min_clearance_m`: lines one
// cell wide with the topology of that space, drawn out into its arms, but not into the corners of rooms.
// Ascending.
std::vector<uint32_t> medialAxis(const StoreyGrid& grid, double min_clearance_m);

}  // namespace sgraphs
