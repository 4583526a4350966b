#pragma once

#include <cstdint>
#include <vector>

#include "common/types/lidar_scan.h"

namespace sgraphs {

// A scan as an image of rings by columns: the index of the return in each cell, -1 where there is none.
class ScanImage {
 public:
  // `kept`: the returns to enter. The scan must have rings. A scan without columns gets them from azimuth.
  ScanImage(const LidarScan& scan, const std::vector<int32_t>& kept);

  int rings() const { return rings_; }
  int columns() const { return columns_; }
  int columnOf(const LidarPoint& p) const;
  // Columns wrap round: the first follows the last.
  int32_t at(int ring, int column) const {
    if (column < 0) column += columns_;
    if (column >= columns_) column -= columns_;
    return cells_[static_cast<size_t>(ring) * static_cast<size_t>(columns_) + static_cast<size_t>(column)];
  }

 private:
  int rings_;
  int columns_;
  bool by_azimuth_;
  std::vector<int32_t> cells_;
};

}  // namespace sgraphs
