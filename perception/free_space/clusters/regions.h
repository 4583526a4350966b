#pragma once

#include <vector>

#include "perception/free_space/clusters/cell_labels.h"
#include "perception/free_space/clusters/free_space_graph_config.h"

namespace sgraphs {

// Free space in regions: labels 0 … count-1, each one region of cells that meet at their sides.
struct Regions {
  CellLabels labels;
  int32_t count = 0;
};

// Widest clearance of each region [m].
std::vector<double> widestClearances(const StoreyGrid& grid, const Regions& regions);

// Regions smaller than `min_area_m2` join the neighbour with the widest way to it; those without neighbour
// are dropped.
void joinSmallRegions(const StoreyGrid& grid, double min_area_m2, Regions& regions);

// Regions that meet through several gaps side by side become one if the gaps together are not narrow, and
// what stands between them takes less than half of the line: shelves, columns, stacks in one room.
void joinThroughParallelGaps(const StoreyGrid& grid, const FreeSpaceGraphConfig& config, Regions& regions);

// Moves the border of two regions onto the straight line of the cut between them.
void straightenAt(const StoreyGrid& grid, const Cut& cut, int32_t a, int32_t b, Regions& regions);

// Each region keeps its largest piece; the others go to the neighbour that they touch most, or become regions
// themselves where they touch none. Then labels are made dense, in the order of their first cells.
void keepConnected(const StoreyGrid& grid, Regions& regions);

// Pieces of a region that do not meet become regions of their own.
void splitIntoPieces(const StoreyGrid& grid, Regions& regions);

}  // namespace sgraphs
