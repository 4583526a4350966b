#pragma once

#include <vector>

#include "perception/free_space/clusters/free_space_graph_config.h"
#include "perception/free_space/clusters/regions.h"

namespace sgraphs {

// Corridors that bend, branch, run in a ring or open into something much wider have no narrow place there:
// they are cut at the corner of the wall inside the bend, along the line of one of the two walls that meet at
// it, across the arm that runs along the other. An arm is cut off only if it is long against its width and
// lies beside something much longer than its width, so that an L-shaped room and a corridor with niches stay
// whole. The longest straight piece keeps the corner. Cuts are left in `regions`; the lines are returned,
// with narrows = false.
std::vector<Cut> cutCorridorArms(const StoreyGrid& grid, const FreeSpaceGraphConfig& config,
                                 Regions& regions);

}  // namespace sgraphs
