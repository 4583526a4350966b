#include "perception/planes/plane_grid.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace sgraphs {
namespace {

// Planes of a keyframe reach as far as the LiDAR: beyond this the cells grow instead of their number.
constexpr double kMaxCellsPerSide = 1000;

}  // namespace

PlaneGrid::PlaneGrid(const std::vector<Eigen::Vector2d>& points, double cell_m, int margin)
    : margin_(margin) {
  Eigen::Vector2d low = Eigen::Vector2d::Zero(), high = Eigen::Vector2d::Zero();
  if (!points.empty()) low = high = points.front();
  for (const Eigen::Vector2d& p : points) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  origin_ = low;
  Eigen::Vector2i size;
  for (int a = 0; a < 2; ++a) {
    const double extent = std::max(high[a] - low[a], 1e-3);
    const double n = std::clamp(std::ceil(extent / cell_m - 1e-6), 1.0, kMaxCellsPerSide);
    size[a] = static_cast<int>(n);
    cell_[a] = extent / n;
  }
  cols_ = size.x() + 2 * margin;
  rows_ = size.y() + 2 * margin;
  cells_.assign(static_cast<size_t>(cols_) * static_cast<size_t>(rows_), 0);
  for (const Eigen::Vector2d& p : points) cells_[cellOf(p)] = 1;
}

size_t PlaneGrid::cellOf(const Eigen::Vector2d& p) const {
  const Eigen::Vector2d at = (p - origin_).cwiseQuotient(cell_);
  const int col = std::clamp(static_cast<int>(at.x()), 0, cols_ - 2 * margin_ - 1) + margin_;
  const int row = std::clamp(static_cast<int>(at.y()), 0, rows_ - 2 * margin_ - 1) + margin_;
  return static_cast<size_t>(row) * static_cast<size_t>(cols_) + static_cast<size_t>(col);
}

bool PlaneGrid::isFilled(const Eigen::Vector2d& p) const {
  const Eigen::Vector2d at = ((p - origin_).cwiseQuotient(cell_)).array().floor();
  if (!at.allFinite() || at.cwiseAbs().maxCoeff() > 2 * kMaxCellsPerSide) return false;
  return this->at(static_cast<int>(at.x()) + margin_, static_cast<int>(at.y()) + margin_);
}

Eigen::Vector2d PlaneGrid::corner(int col, int row) const {
  return origin_ + cell_.cwiseProduct(Eigen::Vector2d(col - margin_, row - margin_));
}

bool PlaneGrid::at(int col, int row) const {
  if (col < 0 || row < 0 || col >= cols_ || row >= rows_) return false;
  return cells_[static_cast<size_t>(row) * static_cast<size_t>(cols_) + static_cast<size_t>(col)] != 0;
}

int PlaneGrid::count() const {
  return std::accumulate(cells_.begin(), cells_.end(), 0);
}

// A square is a row of cells, spread along a column: two passes of counting how far the last such cell is.
void PlaneGrid::spread(int cells, uint8_t value) {
  const auto pass = [&](int lines, int length, size_t line_step, size_t step) {
    std::vector<uint8_t> hit(static_cast<size_t>(length));
    for (int line = 0; line < lines; ++line) {
      uint8_t* first = &cells_[static_cast<size_t>(line) * line_step];
      std::fill(hit.begin(), hit.end(), uint8_t{0});
      int until = -1;
      for (int i = 0; i < length; ++i) {
        if (first[static_cast<size_t>(i) * step] == value) {
          for (int j = std::max(until + 1, i - cells); j <= std::min(i + cells, length - 1); ++j)
            hit[static_cast<size_t>(j)] = 1;
          until = std::max(until, i + cells);
        }
      }
      for (int i = 0; i < length; ++i)
        if (hit[static_cast<size_t>(i)]) first[static_cast<size_t>(i) * step] = value;
    }
  };
  pass(rows_, cols_, static_cast<size_t>(cols_), 1);
  pass(cols_, rows_, 1, static_cast<size_t>(cols_));
}

void PlaneGrid::dilate(int cells) {
  spread(cells, 1);
}

void PlaneGrid::erode(int cells) {
  spread(cells, 0);
}

std::vector<int32_t> PlaneGrid::regions(int* num_regions) const {
  std::vector<int32_t> region_of(cells_.size(), -1);
  std::vector<size_t> open;
  int32_t region = 0;
  const auto width = static_cast<size_t>(cols_);
  for (size_t start = 0; start < cells_.size(); ++start) {
    if (!cells_[start] || region_of[start] >= 0) continue;
    region_of[start] = region;
    open.assign(1, start);
    while (!open.empty()) {
      const size_t cell = open.back();
      open.pop_back();
      const auto visit = [&](size_t next) {
        if (!cells_[next] || region_of[next] >= 0) return;
        region_of[next] = region;
        open.push_back(next);
      };
      if (cell % width > 0) visit(cell - 1);
      if (cell % width + 1 < width) visit(cell + 1);
      if (cell >= width) visit(cell - width);
      if (cell + width < cells_.size()) visit(cell + width);
    }
    ++region;
  }
  *num_regions = region;
  return region_of;
}

}  // namespace sgraphs
