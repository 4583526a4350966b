#include "perception/free_space/clusters/region_cuts.h"

namespace sgraphs {
namespace {

constexpr double kMaxGap_m = 0.4;  // that noise leaves between a cut's end and the wall

}  // namespace

void RegionCutter::take(int x, int y) {
  if (!grid_.contains(x, y) || regions_.labels[grid_.index(x, y)] == kNoLabel) return;
  regions_.labels[grid_.index(x, y)] = kNoLabel;
  taken_.push_back(grid_.index(x, y));
}

void RegionCutter::cut(const Cut& cut) {
  const Eigen::Vector2d along = (cut.right - cut.left).normalized();
  const double step_m = 0.25 * grid_.cell_m;
  // On to what stands at the ends.
  const auto onward = [&](const Eigen::Vector2d& from, const Eigen::Vector2d& direction) {
    double s_m = 0;
    while (s_m < kMaxGap_m && labelAt(grid_, regions_.labels, from + s_m * direction) != kNoLabel)
      s_m += step_m;
    return s_m;
  };
  const double begin_m = -onward(cut.left, -along), end_m = cut.width() + onward(cut.right, along);
  CellStep last = cellAt(grid_, cut.left + begin_m * along);
  for (double s_m = begin_m; s_m < end_m + 2 * step_m; s_m += step_m) {
    const CellStep cell = cellAt(grid_, cut.left + s_m * along);
    if (cell.x != last.x && cell.y != last.y) take(cell.x, last.y);
    take(cell.x, cell.y);
    last = cell;
  }
}

void RegionCutter::finish() {
  if (taken_.empty()) return;
  splitIntoPieces(grid_, regions_);
  CellLabels& labels = regions_.labels;
  for (bool changed = true; changed;) {
    changed = false;
    for (const size_t cell : taken_)
      for (size_t k = 0; k < 4 && labels[cell] == kNoLabel; ++k) {
        const int x = cellX(grid_, cell) + kCellSteps[k].x, y = cellY(grid_, cell) + kCellSteps[k].y;
        if (!grid_.contains(x, y) || labels[grid_.index(x, y)] == kNoLabel) continue;
        labels[cell] = labels[grid_.index(x, y)];
        changed = true;
      }
  }
  taken_.clear();
}

}  // namespace sgraphs
