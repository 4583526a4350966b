#pragma once

#include <vector>

#include "perception/free_space/clusters/free_space_graph_config.h"
#include "perception/free_space/clusters/regions.h"

namespace sgraphs {

// Width of a cut through a region as a share of the narrower side's width: the median of the widths at some
// depths behind it, parallel to it. A median, so that a niche or a door opposite is no width.
double relativeWidth(const StoreyGrid& grid, const CellLabels& labels, const Cut& cut, int32_t label);

// What a cut's relative width must stay below; more where a cut was in the round before, so that cuts do not
// come and go.
double widthLimit(const FreeSpaceGraphConfig& config, const std::vector<Cut>& former, const Cut& cut);

// Joins regions that meet where nothing narrows.
void joinWhereWide(const StoreyGrid& grid, const FreeSpaceGraphConfig& config, const std::vector<Cut>& former,
                   Regions& regions);

// Regions that meet through several gaps side by side become one if the gaps together are not narrow, and
// what stands between them takes less than half of the line: shelves, columns, stacks in one room.
void joinThroughParallelGaps(const StoreyGrid& grid, const FreeSpaceGraphConfig& config, Regions& regions);

}  // namespace sgraphs
