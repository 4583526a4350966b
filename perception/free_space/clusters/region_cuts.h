#pragma once

#include <vector>

#include "perception/free_space/clusters/regions.h"

namespace sgraphs {

// Cuts regions along lines. Until finish() the cells of the lines belong to none; then the pieces are
// regions, and the cells of a line go to one beside it.
class RegionCutter {
 public:
  RegionCutter(const StoreyGrid& grid, Regions& regions) : grid_(grid), regions_(regions) {}

  // Neither a path of cells nor a ray slips through.
  void cut(const Cut& cut);
  void finish();

 private:
  void take(int x, int y);

  const StoreyGrid& grid_;
  Regions& regions_;
  std::vector<size_t> taken_;
};

}  // namespace sgraphs
