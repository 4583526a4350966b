#include "perception/free_space/clusters/contacts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <tuple>

#include "common/geometry/convex_polygon.h"
#include "perception/free_space/clusters/disjoint_sets.h"

namespace sgraphs {
namespace {

struct Touch {
  int32_t a, b;
  uint32_t cell;
  auto operator<=>(const Touch&) const = default;
};

std::vector<Touch> touchesOf(const StoreyGrid& grid, const CellLabels& labels) {
  std::vector<Touch> touches;
  const auto meet = [&](size_t i, size_t j) {
    const int32_t a = labels[i], b = labels[j];
    if (a == b || a == kNoLabel || b == kNoLabel) return;
    touches.push_back({std::min(a, b), std::max(a, b), static_cast<uint32_t>(i)});
    touches.push_back({std::min(a, b), std::max(a, b), static_cast<uint32_t>(j)});
  };
  for (int y = 0; y < grid.height; ++y)
    for (int x = 0; x < grid.width; ++x) {
      const size_t i = grid.index(x, y);
      if (x + 1 < grid.width) meet(i, i + 1);
      if (y + 1 < grid.height) meet(i, grid.index(x, y + 1));
    }
  std::sort(touches.begin(), touches.end());
  touches.erase(std::unique(touches.begin(), touches.end()), touches.end());
  return touches;
}

// Groups the cells of one pair of regions; a gap of one cell is none.
void addContacts(const StoreyGrid& grid, const Touch* begin, const Touch* end,
                 std::vector<Contact>& contacts) {
  const auto n = static_cast<int32_t>(end - begin);
  DisjointSets groups(n);
  for (int32_t i = 0; i < n; ++i)
    for (int32_t j = i + 1; j < n; ++j) {
      const int dy = cellY(grid, begin[j].cell) - cellY(grid, begin[i].cell);
      if (dy > 2) break;
      if (std::abs(cellX(grid, begin[j].cell) - cellX(grid, begin[i].cell)) > 2) continue;
      const int32_t a = groups.find(i), b = groups.find(j);
      if (a != b) groups.join(std::min(a, b), std::max(a, b));
    }
  std::vector<int32_t> slot(static_cast<size_t>(n), kNoLabel);
  for (int32_t i = 0; i < n; ++i) {
    int32_t& at = slot[static_cast<size_t>(groups.find(i))];
    if (at == kNoLabel) {
      at = static_cast<int32_t>(contacts.size());
      contacts.push_back({begin->a, begin->b, {}, begin[i].cell});
    }
    Contact& contact = contacts[static_cast<size_t>(at)];
    contact.cells.push_back(begin[i].cell);
    if (grid.clearance_m[begin[i].cell] > grid.clearance_m[contact.saddle]) contact.saddle = begin[i].cell;
  }
}

// Centres of cells that are not free beside a free one, within a radius.
std::vector<Eigen::Vector2d> edgeCells(const StoreyGrid& grid, const Eigen::Vector2d& center,
                                       double radius_m) {
  std::vector<Eigen::Vector2d> cells;
  const CellStep at = cellAt(grid, center);
  const int r = static_cast<int>(std::ceil(radius_m / grid.cell_m)) + 1;
  for (int y = at.y - r; y <= at.y + r; ++y)
    for (int x = at.x - r; x <= at.x + r; ++x) {
      if (stateAt(grid, x, y) == CellState::kFree) continue;
      if ((grid.center(x, y) - center).norm() > radius_m) continue;
      for (int k = 0; k < 4; ++k)
        if (stateAt(grid, x + kCellSteps[static_cast<size_t>(k)].x,
                    y + kCellSteps[static_cast<size_t>(k)].y) == CellState::kFree) {
          cells.push_back(grid.center(x, y));
          break;
        }
    }
  return cells;
}

// A jamb's face: the mean, over the lines of cells beside it, of the cell that stands out most in each. A
// grid's single nearest cell would make every door narrower by its noise.
Eigen::Vector2d faceOf(const std::vector<Eigen::Vector2d>& cells, const Eigen::Vector2d& jamb,
                       const Eigen::Vector2d& outward, double cell_m) {
  std::array<std::optional<double>, 3> depth_m;  // outward, by line
  for (const Eigen::Vector2d& cell : cells) {
    const double line = std::round(cross(outward, cell - jamb) / cell_m);
    const double d_m = outward.dot(cell - jamb);
    if (std::abs(line) > 1 || std::abs(d_m) > 1.01 * cell_m) continue;
    auto& nearest_m = depth_m[static_cast<size_t>(line + 1)];
    nearest_m = std::min(nearest_m.value_or(d_m), d_m);
  }
  double sum_m = 0;
  int n = 0;
  for (const auto& d_m : depth_m) {
    sum_m += d_m.value_or(0);
    n += d_m ? 1 : 0;
  }
  return n > 0 ? Eigen::Vector2d(jamb + sum_m / n * outward) : jamb;
}

}  // namespace

std::vector<Contact> contactsOf(const StoreyGrid& grid, const CellLabels& labels) {
  const std::vector<Touch> touches = touchesOf(grid, labels);
  std::vector<Contact> contacts;
  for (size_t begin = 0; begin < touches.size();) {
    size_t end = begin;
    while (end < touches.size() &&
           std::tie(touches[end].a, touches[end].b) == std::tie(touches[begin].a, touches[begin].b))
      ++end;
    addContacts(grid, touches.data() + begin, touches.data() + end, contacts);
    begin = end;
  }
  return contacts;
}

Cut turned(const StoreyGrid& grid, const CellLabels& labels, const Contact& contact, Cut cut) {
  double side_a = 0, side_b = 0;
  int num_a = 0, num_b = 0;
  for (const uint32_t cell : contact.cells) {
    const double side = cross(cut.right - cut.left, centerOf(grid, cell) - cut.middle());
    (labels[cell] == contact.b ? side_b : side_a) += side;
    ++(labels[cell] == contact.b ? num_b : num_a);
  }
  if (side_b * num_a < side_a * num_b) std::swap(cut.left, cut.right);
  return cut;
}

std::optional<Cut> narrowestAt(const StoreyGrid& grid, const CellLabels& labels, const Contact& contact) {
  const Eigen::Vector2d saddle = centerOf(grid, contact.saddle);
  const double clearance_m = grid.clearance_m[contact.saddle];
  const auto cells = edgeCells(grid, saddle, 1.3 * clearance_m + 4 * grid.cell_m);
  // The nearest on one side, and the nearest opposite to it.
  const auto nearest = [&](const Eigen::Vector2d& opposite_to) {
    const Eigen::Vector2d* best = nullptr;
    for (const Eigen::Vector2d& cell : cells) {
      const Eigen::Vector2d d = cell - saddle;
      if (d.dot(opposite_to) > -0.5 * d.norm() * opposite_to.norm()) continue;
      if (!best || d.squaredNorm() < (*best - saddle).squaredNorm() - 1e-9) best = &cell;
    }
    return best;
  };
  const Eigen::Vector2d* first = nearest(Eigen::Vector2d::Zero());
  const Eigen::Vector2d* second = first ? nearest(*first - saddle) : nullptr;
  if (!second) return std::nullopt;
  Cut cut{*first, *second, true};
  // The saddle may stand a cell beside the narrowest line.
  double best_m = std::numeric_limits<double>::max();
  const Eigen::Vector2d at_first = *first, at_second = *second;
  for (const Eigen::Vector2d& a : cells) {
    if ((a - at_first).norm() > 0.25) continue;
    for (const Eigen::Vector2d& b : cells) {
      if ((b - at_second).norm() > 0.25 || (b - a).norm() > best_m - 1e-9) continue;
      best_m = (b - a).norm();
      cut.left = a;
      cut.right = b;
    }
  }
  const Eigen::Vector2d axis = (cut.right - cut.left).normalized();
  const Eigen::Vector2d left = faceOf(cells, cut.left, -axis, grid.cell_m);
  cut.right = faceOf(cells, cut.right, axis, grid.cell_m);
  cut.left = left;
  return turned(grid, labels, contact, cut);
}

}  // namespace sgraphs
