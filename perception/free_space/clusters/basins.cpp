#include "perception/free_space/clusters/basins.h"

#include <algorithm>
#include <cmath>

#include "perception/free_space/clusters/disjoint_sets.h"

namespace sgraphs {
namespace {

// Free cells from the largest clearance to the smallest, by index where they are equal. Clearances are roots
// of whole numbers of squared cells: a counting sort is exact.
std::vector<uint32_t> widestFirst(const StoreyGrid& grid) {
  const double scale = 1.0 / (grid.cell_m * grid.cell_m);
  std::vector<uint32_t> key(grid.state.size(), 0);
  uint32_t max_key = 0;
  for (size_t i = 0; i < key.size(); ++i) {
    if (grid.state[i] != CellState::kFree) continue;
    const double c = grid.clearance_m[i];
    key[i] = 1 + static_cast<uint32_t>(std::lround(c * c * scale));
    max_key = std::max(max_key, key[i]);
  }
  std::vector<uint32_t> begin(max_key + 2, 0);
  for (const uint32_t k : key)
    if (k > 0) ++begin[max_key - k + 1];
  for (size_t k = 1; k < begin.size(); ++k) begin[k] += begin[k - 1];
  std::vector<uint32_t> order(begin.back());
  for (size_t i = 0; i < key.size(); ++i)
    if (key[i] > 0) order[begin[max_key - key[i]]++] = static_cast<uint32_t>(i);
  return order;
}

class Flood {
 public:
  Flood(const StoreyGrid& grid, const FreeSpaceGraphConfig& config)
      : grid_(grid), config_(config), labels_(grid.state.size(), kNoLabel) {}

  CellLabels run(int32_t* count) {
    for (const uint32_t cell : widestFirst(grid_)) take(cell);
    std::vector<int32_t> name(static_cast<size_t>(basins_.size()), kNoLabel);
    *count = 0;
    for (int32_t& label : labels_) {
      if (label == kNoLabel) continue;
      int32_t& n = name[static_cast<size_t>(basins_.find(label))];
      if (n == kNoLabel) n = (*count)++;
      label = n;
    }
    return std::move(labels_);
  }

 private:
  void take(size_t cell) {
    const int x = cellX(grid_, cell), y = cellY(grid_, cell);
    int32_t best = kNoLabel;
    float best_clearance_m = -1;
    for (const CellStep& step : kCellSteps) {
      if (!grid_.contains(x + step.x, y + step.y)) continue;
      const size_t next = grid_.index(x + step.x, y + step.y);
      if (labels_[next] == kNoLabel) continue;
      const int32_t root = basins_.find(labels_[next]);
      if (best == kNoLabel) {
        best = root;
        best_clearance_m = grid_.clearance_m[next];
      } else if (root != best) {
        if (joined(cell, best, root)) {
          best = basins_.find(best);
        } else if (grid_.clearance_m[next] > best_clearance_m) {
          best = root;
          best_clearance_m = grid_.clearance_m[next];
        }
      }
    }
    if (best == kNoLabel) {
      best = basins_.add();
      peak_m_.push_back(grid_.clearance_m[cell]);
    }
    labels_[cell] = best;
  }

  // Two basins meet at a cell.
  bool joined(size_t cell, int32_t a, int32_t b) {
    const auto peak = [this](int32_t i) { return peak_m_[static_cast<size_t>(i)]; };
    const double smaller_m = std::min(peak(a), peak(b));
    const double clearance_m = grid_.clearance_m[cell];
    if (isNarrow(clearance_m, smaller_m)) return false;
    if (peak(b) > peak(a) || (peak(b) == peak(a) && b < a)) std::swap(a, b);
    basins_.join(a, b);
    return true;
  }

  // Looser than what is kept in the end (joinWhereWide): a door into a corridor that it meets askew is hardly
  // narrower than the corridor's circles. Half a cell is what the grid itself makes.
  bool isNarrow(double passage_clearance_m, double side_clearance_m) const {
    return passage_clearance_m <= 0.5 * config_.max_passage_m &&
           passage_clearance_m < std::min(0.95 * side_clearance_m, side_clearance_m - 0.6 * grid_.cell_m);
  }

  const StoreyGrid& grid_;
  const FreeSpaceGraphConfig& config_;
  CellLabels labels_;
  DisjointSets basins_;
  std::vector<float> peak_m_;
};

}  // namespace

CellLabels floodBasins(const StoreyGrid& grid, const FreeSpaceGraphConfig& config, int32_t* count) {
  return Flood(grid, config).run(count);
}

}  // namespace sgraphs
