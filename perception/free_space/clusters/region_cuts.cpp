#include "perception/free_space/clusters/region_cuts.h"

namespace sgraphs {

void RegionCutter::take(int x, int y) {
  if (!grid_.contains(x, y) || regions_.labels[grid_.index(x, y)] == kNoLabel) return;
  regions_.labels[grid_.index(x, y)] = kNoLabel;
  taken_.push_back(grid_.index(x, y));
}

void RegionCutter::cut(const Cut& cut) {
  const Eigen::Vector2d along = (cut.right - cut.left).normalized();
  CellStep last = cellAt(grid_, cut.left);
  for (double s_m = 0; s_m < cut.width() + 0.5 * grid_.cell_m; s_m += 0.25 * grid_.cell_m) {
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
