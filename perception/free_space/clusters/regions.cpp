#include "perception/free_space/clusters/regions.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "common/geometry/convex_polygon.h"
#include "perception/free_space/clusters/disjoint_sets.h"

namespace sgraphs {
namespace {

// Calls f(i, j) for all pairs of cells that meet at a side.
template <typename F>
void forEachSide(const StoreyGrid& grid, F f) {
  for (int y = 0; y < grid.height; ++y)
    for (int x = 0; x < grid.width; ++x) {
      const size_t i = grid.index(x, y);
      if (x + 1 < grid.width) f(i, i + 1);
      if (y + 1 < grid.height) f(i, grid.index(x, y + 1));
    }
}

void makeDense(Regions& regions) {
  std::vector<int32_t> name;
  regions.count = 0;
  for (int32_t& label : regions.labels) {
    if (label < 0) continue;
    if (static_cast<size_t>(label) >= name.size()) name.resize(static_cast<size_t>(label) + 1, kNoLabel);
    int32_t& n = name[static_cast<size_t>(label)];
    if (n == kNoLabel) n = regions.count++;
    label = n;
  }
}

// Connected pieces of equal label: piece of each cell, and each piece's label and size.
struct Pieces {
  CellLabels of_cell;
  std::vector<int32_t> label;
  std::vector<int32_t> size;
};

Pieces piecesOf(const StoreyGrid& grid, const CellLabels& labels) {
  Pieces pieces;
  pieces.of_cell.assign(labels.size(), kNoLabel);
  DisjointSets sets;
  for (int y = 0; y < grid.height; ++y)
    for (int x = 0; x < grid.width; ++x) {
      const size_t i = grid.index(x, y), below = i - static_cast<size_t>(grid.width);
      if (labels[i] == kNoLabel) continue;
      int32_t& piece = pieces.of_cell[i];
      if (x > 0 && labels[i - 1] == labels[i]) piece = pieces.of_cell[i - 1];
      if (y > 0 && labels[below] == labels[i]) {
        const int32_t other = pieces.of_cell[below];
        if (piece == kNoLabel)
          piece = other;
        else if (piece != other)
          sets.join(std::min(sets.find(piece), sets.find(other)),
                    std::max(sets.find(piece), sets.find(other)));
      }
      if (piece == kNoLabel) piece = sets.add();
    }
  std::vector<int32_t> name(static_cast<size_t>(sets.size()), kNoLabel);
  for (size_t i = 0; i < labels.size(); ++i) {
    int32_t& piece = pieces.of_cell[i];
    if (piece == kNoLabel) continue;
    int32_t& n = name[static_cast<size_t>(sets.find(piece))];
    if (n == kNoLabel) {
      n = static_cast<int32_t>(pieces.label.size());
      pieces.label.push_back(labels[i]);
      pieces.size.push_back(0);
    }
    piece = n;
    ++pieces.size[static_cast<size_t>(n)];
  }
  return pieces;
}

// For each label its largest piece (the first of equals).
std::vector<uint8_t> mainPieces(const Pieces& pieces, int32_t count) {
  std::vector<int32_t> main(static_cast<size_t>(count), kNoLabel);
  for (size_t p = 0; p < pieces.label.size(); ++p) {
    int32_t& m = main[static_cast<size_t>(pieces.label[p])];
    if (m == kNoLabel || pieces.size[p] > pieces.size[static_cast<size_t>(m)]) m = static_cast<int32_t>(p);
  }
  std::vector<uint8_t> is_main(pieces.label.size(), 0);
  for (const int32_t m : main)
    if (m != kNoLabel) is_main[static_cast<size_t>(m)] = 1;
  return is_main;
}

}  // namespace

std::vector<double> widestClearances(const StoreyGrid& grid, const Regions& regions) {
  std::vector<double> widest(static_cast<size_t>(regions.count), 0);
  for (size_t i = 0; i < regions.labels.size(); ++i) {
    if (regions.labels[i] == kNoLabel) continue;
    double& w = widest[static_cast<size_t>(regions.labels[i])];
    w = std::max(w, static_cast<double>(grid.clearance_m[i]));
  }
  return widest;
}

void joinSmallRegions(const StoreyGrid& grid, double min_area_m2, Regions& regions) {
  const auto n = static_cast<size_t>(regions.count);
  std::vector<int> cells(n, 0);
  for (const int32_t label : regions.labels)
    if (label != kNoLabel) ++cells[static_cast<size_t>(label)];
  const double min_cells = min_area_m2 / (grid.cell_m * grid.cell_m);
  if (std::none_of(cells.begin(), cells.end(), [min_cells](int size) { return size < min_cells; })) return;
  // Clearance of the widest way between two regions.
  std::map<std::pair<int32_t, int32_t>, float> ways;
  forEachSide(grid, [&](size_t i, size_t j) {
    const int32_t a = regions.labels[i], b = regions.labels[j];
    if (a == b || a == kNoLabel || b == kNoLabel) return;
    float& way = ways.try_emplace({std::min(a, b), std::max(a, b)}, 0.0F).first->second;
    way = std::max(way, std::min(grid.clearance_m[i], grid.clearance_m[j]));
  });
  DisjointSets sets(regions.count);
  std::vector<uint8_t> done(n, 0);
  while (true) {
    size_t small = n;
    for (size_t i = 0; i < n; ++i)
      if (!done[i] && cells[i] < min_cells && (small == n || cells[i] < cells[small])) small = i;
    if (small == n) break;
    done[small] = 1;
    int32_t host = kNoLabel;
    float widest_m = -1;
    for (const auto& [pair, way_m] : ways) {
      const int32_t a = sets.find(pair.first), b = sets.find(pair.second);
      const auto s = static_cast<int32_t>(small);
      if (a == b || (a != s && b != s) || way_m <= widest_m) continue;
      widest_m = way_m;
      host = a == s ? b : a;
    }
    if (host == kNoLabel) continue;
    sets.join(host, static_cast<int32_t>(small));
    cells[static_cast<size_t>(host)] += cells[small];
  }
  for (int32_t& label : regions.labels) {
    if (label == kNoLabel) continue;
    const int32_t root = sets.find(label);
    label = cells[static_cast<size_t>(root)] < min_cells ? kNoLabel : root;
  }
  makeDense(regions);
}

void joinRegions(DisjointSets& sets, Regions& regions) {
  for (int32_t& label : regions.labels)
    if (label != kNoLabel) label = sets.find(label);
  makeDense(regions);
}

void straightenAt(const StoreyGrid& grid, const Cut& cut, int32_t a, int32_t b, Regions& regions) {
  constexpr double kReach_m = 0.5;  // deeper than a wall with its door
  const Eigen::Vector2d along = (cut.right - cut.left).normalized();
  const double half_m = 0.5 * cut.width() + grid.cell_m;
  const CellStep at = cellAt(grid, cut.middle());
  const int r = static_cast<int>(std::ceil(std::hypot(half_m, kReach_m) / grid.cell_m)) + 1;
  for (int y = at.y - r; y <= at.y + r; ++y)
    for (int x = at.x - r; x <= at.x + r; ++x) {
      if (!grid.contains(x, y)) continue;
      int32_t& label = regions.labels[grid.index(x, y)];
      if (label != a && label != b) continue;
      const Eigen::Vector2d offset = grid.center(x, y) - cut.middle();
      const double depth_m = cross(along, offset);
      if (std::abs(along.dot(offset)) > half_m || std::abs(depth_m) > kReach_m) continue;
      label = depth_m > 0 ? b : a;
    }
}

void keepConnected(const StoreyGrid& grid, Regions& regions) {
  Pieces pieces = piecesOf(grid, regions.labels);
  std::vector<uint8_t> settled = mainPieces(pieces, regions.count);
  if (std::find(settled.begin(), settled.end(), 0) == settled.end()) return makeDense(regions);
  while (std::find(settled.begin(), settled.end(), 0) != settled.end()) {
    // How much each loose piece touches settled ones, by (piece, label).
    std::map<std::pair<int32_t, int32_t>, int> touch;
    forEachSide(grid, [&](size_t i, size_t j) {
      int32_t p = pieces.of_cell[i], q = pieces.of_cell[j];
      if (p == q || p == kNoLabel || q == kNoLabel) return;
      if (settled[static_cast<size_t>(p)]) std::swap(p, q);
      if (settled[static_cast<size_t>(p)] || !settled[static_cast<size_t>(q)]) return;
      ++touch[{p, pieces.label[static_cast<size_t>(q)]}];
    });
    if (touch.empty()) {
      for (size_t p = 0; p < settled.size(); ++p)
        if (!settled[p]) pieces.label[p] = regions.count++;
      break;
    }
    for (auto it = touch.begin(); it != touch.end();) {
      const int32_t piece = it->first.first;
      auto best = it;
      for (; it != touch.end() && it->first.first == piece; ++it)
        if (it->second > best->second) best = it;
      pieces.label[static_cast<size_t>(piece)] = best->first.second;
      settled[static_cast<size_t>(piece)] = 1;
    }
  }
  for (size_t i = 0; i < regions.labels.size(); ++i)
    if (pieces.of_cell[i] != kNoLabel)
      regions.labels[i] = pieces.label[static_cast<size_t>(pieces.of_cell[i])];
  makeDense(regions);
}

void splitIntoPieces(const StoreyGrid& grid, Regions& regions) {
  Pieces pieces = piecesOf(grid, regions.labels);
  regions.labels = std::move(pieces.of_cell);
  regions.count = static_cast<int32_t>(pieces.label.size());
}

}  // namespace sgraphs
