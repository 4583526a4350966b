#pragma once

#include <vector>

#include "perception/free_space/clusters/regions.h"

namespace sgraphs {

// Where two regions of a segmentation meet; a < b.
struct RegionPassage {
  int32_t a = kNoLabel, b = kNoLabel;
  Cut cut;  // left and right as seen when walking from a to b
};

struct Segmentation {
  Regions regions;
  std::vector<RegionPassage> passages;
};

// Free space of a storey in rooms, arms of corridors, and the like. `former` are the cuts of the round before
// (see floodBasins).
Segmentation segment(const StoreyGrid& rooms, const FreeSpaceGraphConfig& config,
                     const std::vector<Cut>& former);

}  // namespace sgraphs
