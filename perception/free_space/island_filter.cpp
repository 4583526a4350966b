#include "perception/free_space/island_filter.h"

#include <algorithm>
#include <utility>

namespace sgraphs {
namespace {

// One island within a window. What meets the window's edge is larger than the window's margin.
class IslandSearch {
 public:
  IslandSearch(const StoreyGrid& grid, const std::vector<CellState>& raw, const std::vector<uint8_t>& keep,
               const CellBox& window, const IslandRule& rule)
      : grid_(grid), raw_(raw), keep_(keep), window_(window), rule_(rule) {
    seen_.assign(static_cast<size_t>(window.width()) * static_cast<size_t>(window.height()), 0);
  }

  bool seen(int x, int y) const { return seen_[local(x, y)] != 0; }

  // Collects the island of this cell; true if the rule lets it become free.
  bool collect(int x, int y) {
    cells_.clear();
    CellBox extent;
    bool stays = false;
    push(x, y);
    for (size_t i = 0; i < cells_.size(); ++i) {
      const auto [cx, cy] = cells_[i];
      extent.include(cx, cy);
      const size_t index = grid_.index(cx, cy);
      stays = stays || (rule_.only_unknown && raw_[index] == CellState::kObstacle) ||
              (!keep_.empty() && keep_[index]) || cx == window_.x0 || cy == window_.y0 ||
              cx == window_.x1 - 1 || cy == window_.y1 - 1;
      for (int ny = std::max(cy - 1, window_.y0); ny <= std::min(cy + 1, window_.y1 - 1); ++ny)
        for (int nx = std::max(cx - 1, window_.x0); nx <= std::min(cx + 1, window_.x1 - 1); ++nx)
          if (!seen(nx, ny) && raw_[grid_.index(nx, ny)] != CellState::kFree) push(nx, ny);
    }
    return !stays && extent.width() <= rule_.max_cells && extent.height() <= rule_.max_cells;
  }

  const std::vector<std::pair<int, int>>& cells() const { return cells_; }

 private:
  size_t local(int x, int y) const {
    return static_cast<size_t>(y - window_.y0) * static_cast<size_t>(window_.width()) +
           static_cast<size_t>(x - window_.x0);
  }
  void push(int x, int y) {
    seen_[local(x, y)] = 1;
    cells_.emplace_back(x, y);
  }

  const StoreyGrid& grid_;
  const std::vector<CellState>& raw_;
  const std::vector<uint8_t>& keep_;
  CellBox window_;
  IslandRule rule_;
  std::vector<uint8_t> seen_;
  std::vector<std::pair<int, int>> cells_;
};

}  // namespace

CellBox filterIslands(StoreyGrid& grid, const std::vector<CellState>& raw, const std::vector<uint8_t>& keep,
                      const CellBox& changed, const IslandRule& rule) {
  CellBox differs;
  if (changed.empty()) return differs;
  // An island that a change made or unmade lies within its own extent of the change.
  const CellBox out = changed.grown(rule.max_cells + 1).clipped(grid.width, grid.height);
  const CellBox window = changed.grown(2 * rule.max_cells + 3).clipped(grid.width, grid.height);
  const auto width = static_cast<size_t>(out.width());
  std::vector<CellState> wanted(width * static_cast<size_t>(out.height()));
  auto at = [&](int x, int y) -> CellState& {
    return wanted[static_cast<size_t>(y - out.y0) * width + static_cast<size_t>(x - out.x0)];
  };
  for (int y = out.y0; y < out.y1; ++y)
    for (int x = out.x0; x < out.x1; ++x) at(x, y) = raw[grid.index(x, y)];
  IslandSearch search(grid, raw, keep, window, rule);
  for (int y = out.y0; y < out.y1; ++y)
    for (int x = out.x0; x < out.x1; ++x) {
      if (raw[grid.index(x, y)] == CellState::kFree || search.seen(x, y)) continue;
      if (!search.collect(x, y)) continue;
      for (const auto& [cx, cy] : search.cells())
        if (out.contains(cx, cy)) at(cx, cy) = CellState::kFree;
    }
  for (int y = out.y0; y < out.y1; ++y)
    for (int x = out.x0; x < out.x1; ++x) {
      CellState& state = grid.state[grid.index(x, y)];
      if (state == at(x, y)) continue;
      state = at(x, y);
      differs.include(x, y);
    }
  return differs;
}

}  // namespace sgraphs
