#include "perception/rooms/line_cells.h"

#include <algorithm>
#include <utility>

namespace sgraphs {
namespace {

struct Work {
  LineCell cell;
  std::vector<Polygon2d> parts;
};

// The part of a cell on one side of a line (side +1: in front), and of what lies in it.
Work half(const Work& work, const OutlineLine& line, int index, double side) {
  Work result;
  result.cell.front = work.cell.front | (side > 0 ? uint64_t{1} << index : 0);
  const Polygon2d& corners = work.cell.corners;
  const auto sideOf = [&](const Eigen::Vector2d& p) { return side * line.distance(p); };
  for (size_t i = 0; i < corners.size(); ++i) {
    const Eigen::Vector2d& p = corners[i];
    const Eigen::Vector2d& q = corners[(i + 1) % corners.size()];
    const double side_p = sideOf(p), side_q = sideOf(q);
    if (side_p > 0) {
      result.cell.corners.push_back(p);
      result.cell.lines.push_back(work.cell.lines[i]);
    }
    if ((side_p > 0) == (side_q > 0)) continue;
    result.cell.corners.emplace_back(p + side_p / (side_p - side_q) * (q - p));
    result.cell.lines.push_back(side_p > 0 ? index : work.cell.lines[i]);
  }
  for (const Polygon2d& part : work.parts) {
    Polygon2d kept = clipped(part, side * line.normal, side * line.d);
    if (!kept.empty()) result.parts.push_back(std::move(kept));
  }
  return result;
}

bool isCut(const LineCell& cell, const OutlineLine& line, bool* in_front) {
  double least = line.distance(cell.corners.front()), most = least;
  for (const Eigen::Vector2d& p : cell.corners) {
    least = std::min(least, line.distance(p));
    most = std::max(most, line.distance(p));
  }
  *in_front = most > -least;
  constexpr double kTouch_m = 1e-7;  // lines that only touch a corner
  return least < -kTouch_m && most > kTouch_m;
}

}  // namespace

std::vector<LineCell> cellsOf(const Eigen::AlignedBox2d& frame, const std::vector<OutlineLine>& lines,
                              const std::vector<Polygon2d>& parts) {
  const Eigen::Vector2d &a = frame.min(), &b = frame.max();
  std::vector<Work> works(1);
  works[0].cell.corners = {a, {b.x(), a.y()}, b, {a.x(), b.y()}};
  works[0].cell.lines = {-1, -1, -1, -1};
  works[0].parts = parts;
  for (size_t i = 0; i < lines.size(); ++i) {
    std::vector<Work> next;
    next.reserve(2 * works.size());
    for (Work& work : works) {
      bool in_front = false;
      if (isCut(work.cell, lines[i], &in_front)) {
        next.push_back(half(work, lines[i], static_cast<int>(i), 1.0));
        next.push_back(half(work, lines[i], static_cast<int>(i), -1.0));
      } else {
        if (in_front) work.cell.front |= uint64_t{1} << i;
        next.push_back(std::move(work));
      }
    }
    works = std::move(next);
  }
  std::vector<LineCell> cells;
  for (Work& work : works) {
    work.cell.area_m2 = polygonArea(work.cell.corners);
    for (const Polygon2d& part : work.parts) work.cell.covered_m2 += std::abs(polygonArea(part));
    work.cell.covered_m2 = std::min(work.cell.covered_m2, work.cell.area_m2);
    cells.push_back(std::move(work.cell));
  }
  return cells;
}

}  // namespace sgraphs
