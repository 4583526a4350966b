#pragma once

#include <vector>

#include "common/base/ids.h"
#include "perception/free_space/clusters/regions.h"

namespace sgraphs {

// Gives the regions of one storey the ids they had in the round before, by the cells they share: each former
// cluster goes to the region that holds most of its cells (split: the larger part), and a region that several
// go to takes the lowest id (merged). Ids of others are new: `next` counts on.
class ClusterIdentity {
 public:
  // One id per region; none twice.
  std::vector<ClusterId> identify(const StoreyGrid& grid, const Regions& regions, int64_t* next);

 private:
  StoreyGrid former_grid_;           // its place only
  std::vector<int64_t> former_ids_;  // by cell; -1: of none
};

}  // namespace sgraphs
