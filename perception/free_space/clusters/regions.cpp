#include "perception/free_space/clusters/regions.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "common/geometry/convex_polygon.h"
#include "perception/free_space/clusters/basins.h"
#include "perception/free_space/clusters/contacts.h"
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

void apply(DisjointSets& sets, Regions& regions) {
  for (int32_t& label : regions.labels)
    if (label != kNoLabel) label = sets.find(label);
  makeDense(regions);
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
  std::vector<uint32_t> open;
  for (size_t start = 0; start < labels.size(); ++start) {
    if (labels[start] == kNoLabel || pieces.of_cell[start] != kNoLabel) continue;
    const auto piece = static_cast<int32_t>(pieces.label.size());
    pieces.label.push_back(labels[start]);
    pieces.size.push_back(0);
    pieces.of_cell[start] = piece;
    open.push_back(static_cast<uint32_t>(start));
    while (!open.empty()) {
      const size_t cell = open.back();
      open.pop_back();
      ++pieces.size.back();
      const int x = cellX(grid, cell), y = cellY(grid, cell);
      for (size_t k = 0; k < 4; ++k) {
        if (!grid.contains(x + kCellSteps[k].x, y + kCellSteps[k].y)) continue;
        const size_t next = grid.index(x + kCellSteps[k].x, y + kCellSteps[k].y);
        if (pieces.of_cell[next] != kNoLabel || labels[next] != labels[start]) continue;
        pieces.of_cell[next] = piece;
        open.push_back(static_cast<uint32_t>(next));
      }
    }
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

// The ways between two regions, as if they were one: gaps along a line, and what stands between them.
bool isOneRoom(const FreeSpaceGraphConfig& config, const std::vector<Cut>& gaps, double side_clearance_m) {
  double free_m = 0;
  const Cut *first = &gaps.front(), *last = first;
  double span_m = 0;
  for (const Cut& a : gaps) {
    free_m += a.width();
    for (const Cut& b : gaps)
      if ((b.middle() - a.middle()).norm() > span_m) {
        span_m = (b.middle() - a.middle()).norm();
        first = &a;
        last = &b;
      }
  }
  const double line_m = span_m + 0.5 * (first->width() + last->width());
  return free_m > 0.5 * line_m && 0.5 * free_m > config.narrow_ratio * side_clearance_m;
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
  // Clearance of the widest way between two regions.
  std::map<std::pair<int32_t, int32_t>, float> ways;
  forEachSide(grid, [&](size_t i, size_t j) {
    const int32_t a = regions.labels[i], b = regions.labels[j];
    if (a == b || a == kNoLabel || b == kNoLabel) return;
    float& way = ways.try_emplace({std::min(a, b), std::max(a, b)}, 0.0F).first->second;
    way = std::max(way, std::min(grid.clearance_m[i], grid.clearance_m[j]));
  });
  const double min_cells = min_area_m2 / (grid.cell_m * grid.cell_m);
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

void joinThroughParallelGaps(const StoreyGrid& grid, const FreeSpaceGraphConfig& config, Regions& regions) {
  // A join may lay gaps side by side that were not before.
  for (int round = 0; round < 4; ++round) {
    const std::vector<Contact> contacts = contactsOf(grid, regions.labels);
    const std::vector<double> widest = widestClearances(grid, regions);
    DisjointSets sets(regions.count);
    bool joined = false;
    for (size_t begin = 0; begin < contacts.size();) {
      const int32_t a = contacts[begin].a, b = contacts[begin].b;
      std::vector<Cut> gaps;
      size_t end = begin;
      for (; end < contacts.size() && std::tie(contacts[end].a, contacts[end].b) == std::tie(a, b); ++end)
        if (const auto cut = narrowestAt(grid, regions.labels, contacts[end])) gaps.push_back(*cut);
      begin = end;
      const double side_m = std::min(widest[static_cast<size_t>(a)], widest[static_cast<size_t>(b)]);
      if (gaps.size() < 2 || sets.find(a) == sets.find(b) || !isOneRoom(config, gaps, side_m)) continue;
      sets.join(std::min(sets.find(a), sets.find(b)), std::max(sets.find(a), sets.find(b)));
      joined = true;
    }
    if (!joined) return;
    apply(sets, regions);
  }
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
