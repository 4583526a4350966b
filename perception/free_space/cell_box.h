#pragma once

#include <algorithm>

namespace sgraphs {

// Cells [x0, x1) x [y0, y1).
struct CellBox {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;

  bool empty() const { return x0 >= x1 || y0 >= y1; }
  int width() const { return x1 - x0; }
  int height() const { return y1 - y0; }
  bool contains(int x, int y) const { return x >= x0 && x < x1 && y >= y0 && y < y1; }

  void include(int x, int y) {
    if (empty()) {
      *this = {x, y, x + 1, y + 1};
    } else {
      *this = {std::min(x0, x), std::min(y0, y), std::max(x1, x + 1), std::max(y1, y + 1)};
    }
  }
  CellBox grown(int cells) const { return {x0 - cells, y0 - cells, x1 + cells, y1 + cells}; }
  CellBox clipped(int max_x, int max_y) const {
    return {std::max(x0, 0), std::max(y0, 0), std::min(x1, max_x), std::min(y1, max_y)};
  }
};

}  // namespace sgraphs
