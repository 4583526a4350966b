#include "perception/free_space/distance_field.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace sgraphs {
namespace {

// Distance transform of sampled functions by the lower envelope of parabolas, one axis after the other
// (Felzenszwalb and Huttenlocher, 2012). All in whole cells, so that nothing depends on rounding.
class WindowTransform {
 public:
  WindowTransform(StoreyGrid& grid, const CellBox& out, int reach)
      : grid_(grid), out_(out), in_(out.grown(reach + 1)), reach_(reach) {
    const auto width = static_cast<size_t>(in_.width());
    column_.assign(width * static_cast<size_t>(in_.height()), far());
    site_.resize(width);
    begin_.resize(width + 1);
  }

  void run(double reach_m) {
    downAndUp();
    for (int y = out_.y0; y < out_.y1; ++y) {
      int x = in_.x0;
      while (x < out_.x1) {
        if (!isFree(x, y)) {
          if (out_.contains(x, y)) grid_.clearance_m[grid_.index(x, y)] = 0;
          ++x;
          continue;
        }
        int end = x;
        while (end < in_.x1 && isFree(end, y)) ++end;
        if (end > out_.x0) rowRun(x, end, y, reach_m);
        x = end;
      }
    }
  }

 private:
  uint16_t far() const { return static_cast<uint16_t>(reach_ + 1); }
  bool isFree(int x, int y) const {
    return grid_.contains(x, y) && grid_.state[grid_.index(x, y)] == CellState::kFree;
  }
  uint16_t& column(int x, int y) {
    return column_[static_cast<size_t>(y - in_.y0) * static_cast<size_t>(in_.width()) +
                   static_cast<size_t>(x - in_.x0)];
  }

  // Distance along the column to the nearest cell that is not free.
  void downAndUp() {
    for (int y = in_.y0; y < in_.y1; ++y)
      for (int x = in_.x0; x < in_.x1; ++x) {
        const uint16_t before = y > in_.y0 ? column(x, y - 1) : far();
        column(x, y) =
            isFree(x, y) ? std::min<uint16_t>(static_cast<uint16_t>(before + 1), far()) : uint16_t{0};
      }
    for (int y = in_.y1 - 2; y >= in_.y0; --y)
      for (int x = in_.x0; x < in_.x1; ++x)
        column(x, y) = std::min<uint16_t>(column(x, y), static_cast<uint16_t>(column(x, y + 1) + 1));
  }

  // Free cells [x0, x1) of a row, with the cell before and the cell after, which hide all that lies beyond.
  void rowRun(int x0, int x1, int y, double reach_m) {
    const int first = std::max(x0 - 1, in_.x0), last = std::min(x1, in_.x1 - 1);
    const int last_wanted = std::min(x1, out_.x1) - 1;
    size_t n = 0;  // parabolas in the envelope: of site_[i], lowest from begin_[i] on
    for (int q = first; q <= last; ++q) {
      const int g = column(q, y);
      if (g > reach_) continue;
      double from = -1e9;
      while (n > 0) {
        const int v = site_[n - 1];
        const int gv = column(v, y);
        from =
            (static_cast<double>(g * g - gv * gv) + static_cast<double>(q) * q - static_cast<double>(v) * v) /
            (2.0 * (q - v));
        if (from > begin_[n - 1]) break;
        --n;
        from = -1e9;
      }
      site_[n] = q;
      begin_[n] = from;
      ++n;
    }
    size_t i = 0;
    for (int x = std::max(x0, out_.x0); x <= last_wanted; ++x) {
      double clearance = reach_m;
      if (n > 0) {
        while (i + 1 < n && begin_[i + 1] <= x) ++i;
        const int dx = x - site_[i], g = column(site_[i], y);
        clearance = std::min(reach_m, grid_.cell_m * std::sqrt(static_cast<double>(dx * dx + g * g)));
      }
      grid_.clearance_m[grid_.index(x, y)] = static_cast<float>(clearance);
    }
  }

  StoreyGrid& grid_;
  CellBox out_;  // cells to compute
  CellBox in_;   // cells that they depend on; may reach over the grid's edge
  int reach_;    // [cells]
  std::vector<uint16_t> column_;
  std::vector<int> site_;
  std::vector<double> begin_;
};

}  // namespace

void updateClearance(StoreyGrid& grid, const CellBox& changed, double reach_m) {
  if (changed.empty()) return;
  const int reach = static_cast<int>(std::ceil(reach_m / grid.cell_m));
  const CellBox out = changed.grown(reach).clipped(grid.width, grid.height);
  if (!out.empty()) WindowTransform(grid, out, reach).run(reach_m);
}

}  // namespace sgraphs
