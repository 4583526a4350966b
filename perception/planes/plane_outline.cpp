#include "perception/planes/plane_outline.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "common/geometry/simplify_chain.h"
#include "perception/planes/plane_grid.h"

namespace sgraphs {
namespace {

double side(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& p) {
  return cross(b - a, p - a);
}

bool segmentsTouch(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c,
                   const Eigen::Vector2d& d) {
  if (std::max(a.x(), b.x()) < std::min(c.x(), d.x()) || std::max(c.x(), d.x()) < std::min(a.x(), b.x()) ||
      std::max(a.y(), b.y()) < std::min(c.y(), d.y()) || std::max(c.y(), d.y()) < std::min(a.y(), b.y()))
    return false;
  return side(a, b, c) * side(a, b, d) <= 0 && side(c, d, a) * side(c, d, b) <= 0;
}

// Walks along the edges of the filled cells with the filled side on the left, from the lowest cell's lower
// left corner, and keeps the turns. Where two cells touch at a corner only it turns left: one region of
// edge-connected cells has one outer border.
Polygon borderOf(const PlaneGrid& grid) {
  int col = 0, row = 0;
  while (row < grid.rows() && !grid.at(col, row))
    if (++col == grid.cols()) {
      col = 0;
      ++row;
    }
  if (row == grid.rows()) return {};
  const int start_col = col, start_row = row;
  constexpr int kStep[4][2] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}};
  // Cells to the left and right ahead of a corner, by direction.
  constexpr int kLeft[4][2] = {{0, 0}, {-1, 0}, {-1, -1}, {0, -1}};
  constexpr int kRight[4][2] = {{0, -1}, {0, 0}, {-1, 0}, {-1, -1}};
  Polygon border;
  int direction = 0;
  do {
    col += kStep[direction][0];
    row += kStep[direction][1];
    const bool left = grid.at(col + kLeft[direction][0], row + kLeft[direction][1]);
    const bool right = grid.at(col + kRight[direction][0], row + kRight[direction][1]);
    if (left && !right) continue;  // straight on
    border.push_back(grid.corner(col, row));
    direction = left ? (direction + 3) % 4 : (direction + 1) % 4;
  } while (col != start_col || row != start_row);
  return border;
}

Polygon simplified(const Polygon& polygon, double tolerance_m) {
  const size_t n = polygon.size();
  if (n < 5) return polygon;
  // Two corners that stay in any case: the ends of the polygon in one direction.
  const auto by_x = [](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y();
  };
  const auto first =
      static_cast<size_t>(std::min_element(polygon.begin(), polygon.end(), by_x) - polygon.begin());
  auto last = static_cast<size_t>(std::max_element(polygon.begin(), polygon.end(), by_x) - polygon.begin());
  if (last < first) last += n;
  std::vector<uint8_t> stays(n, 0);
  stays[first] = stays[last % n] = 1;
  simplifyChain(polygon, first, last, tolerance_m, stays);
  simplifyChain(polygon, last, first + n, tolerance_m, stays);
  Polygon result;
  for (size_t i = 0; i < n; ++i)
    if (stays[i]) result.push_back(polygon[i]);
  return result;
}

Polygon withAtMost(const Polygon& polygon, size_t max_corners, double tolerance_m) {
  Polygon result = simplified(polygon, tolerance_m);
  while (result.size() > max_corners) result = simplified(polygon, tolerance_m *= 1.4);
  return result;
}

}  // namespace

bool isSimple(const Polygon& polygon) {
  const size_t n = polygon.size();
  if (n < 3) return false;
  for (size_t i = 0; i < n; ++i)
    for (size_t j = i + 2; j < n; ++j) {
      if (i == 0 && j + 1 == n) continue;
      if (segmentsTouch(polygon[i], polygon[i + 1], polygon[j], polygon[(j + 1) % n])) return false;
    }
  return true;
}

Outline outlineOf(const std::vector<Eigen::Vector2d>& points, double cell_m, double link_m, int max_corners) {
  const int radius = static_cast<int>(std::lround(0.5 * link_m / cell_m));
  PlaneGrid grid(points, cell_m, radius + 1);
  const int occupied = grid.count();
  grid.dilate(radius);
  grid.erode(radius);
  const int closed = grid.count();
  int num_regions = 0;
  const std::vector<int32_t> regions = grid.regions(&num_regions);
  Outline outline;
  outline.filled = closed > 0 ? static_cast<double>(occupied) / closed : 0;
  const auto limit = static_cast<size_t>(max_corners);
  if (num_regions == 1) {
    outline.polygon = withAtMost(borderOf(grid), limit, 0.75 * cell_m);
    if (isSimple(outline.polygon) && polygonArea(outline.polygon) > 0) return outline;
  }
  outline.polygon = withAtMost(convexHull(points), limit, 1e-3);
  return outline;
}

}  // namespace sgraphs
