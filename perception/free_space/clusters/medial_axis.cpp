#include "perception/free_space/clusters/medial_axis.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "perception/free_space/clusters/cell_labels.h"

namespace sgraphs {
namespace {

// Neighbours around a cell, in turn.
constexpr std::array<CellStep, 8> kRound{
    {{1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}, {-1, -1}, {0, -1}, {1, -1}}};

// For each pattern of neighbours: whether a cell can go without parting or joining anything (free cells meet
// at sides and corners, others at sides).
std::array<bool, 256> makeSimple() {
  std::array<bool, 256> simple{};
  for (unsigned pattern = 0; pattern < 256; ++pattern) {
    const auto on = [pattern](unsigned k) { return (pattern >> (k % 8)) & 1U; };
    // Yokoi's number of connected parts around the cell, for 8-connected figures.
    int parts = 0;
    for (unsigned k = 0; k < 8; k += 2) parts += !on(k) && (on(k + 1) || on(k + 2)) ? 1 : 0;
    simple[pattern] = parts == 1;
  }
  return simple;
}

class Thinning {
 public:
  Thinning(const StoreyGrid& grid, double min_clearance_m)
      : grid_(grid), edge_m_(min_clearance_m + 1.5 * grid.cell_m) {
    for (size_t k = 0; k < 8; ++k)
      offsets_[k] = kRound[k].y * static_cast<std::ptrdiff_t>(grid.width) + kRound[k].x;
    level_ = levels(min_clearance_m);
  }

  std::vector<uint32_t> run() {
    std::vector<std::vector<uint32_t>> buckets;
    for (size_t i = 0; i < level_.size(); ++i) {
      if (level_[i] == 0) continue;
      if (level_[i] >= buckets.size()) buckets.resize(level_[i] + 1U);
      if (grid_.clearance_m[i] < edge_m_ && onEdge(i)) buckets[level_[i]].push_back(static_cast<uint32_t>(i));
    }
    // From the edge inwards; a cell is looked at when something beside it went.
    for (size_t level = 1; level < buckets.size(); ++level)
      for (size_t k = 0; k < buckets[level].size(); ++k) {
        const size_t cell = buckets[level][k];
        if (level_[cell] == 0 || !canGo(cell)) continue;
        level_[cell] = 0;
        forEachNeighbour(cell, [&](size_t next) {
          if (level_[next] > 0)
            buckets[std::max<size_t>(level, level_[next])].push_back(static_cast<uint32_t>(next));
        });
      }
    std::vector<uint32_t> axis;
    for (size_t i = 0; i < level_.size(); ++i)
      if (level_[i] > 0) axis.push_back(static_cast<uint32_t>(i));
    return axis;
  }

 private:
  // Order in which cells go: tenths of a cell of clearance, from 1; 0: not to be looked at. Where the
  // clearance ends at the grid's reach, the order goes on with the steps from the edge of that plateau.
  std::vector<uint16_t> levels(double min_clearance_m) const {
    std::vector<uint16_t> level(grid_.state.size(), 0);
    const float top_m = *std::max_element(grid_.clearance_m.begin(), grid_.clearance_m.end()) - 1e-4F;
    const double tenths = 10 / grid_.cell_m;
    std::vector<uint32_t> plateau;
    for (int y = 1; y + 1 < grid_.height; ++y)
      for (int x = 1; x + 1 < grid_.width; ++x) {
        const size_t i = grid_.index(x, y);
        if (grid_.state[i] != CellState::kFree || grid_.clearance_m[i] < min_clearance_m) continue;
        level[i] = static_cast<uint16_t>(1.5 + grid_.clearance_m[i] * tenths);
        if (grid_.clearance_m[i] >= top_m) plateau.push_back(static_cast<uint32_t>(i));
      }
    raisePlateau(plateau, level);
    return level;
  }

  void raisePlateau(const std::vector<uint32_t>& plateau, std::vector<uint16_t>& level) const {
    constexpr uint16_t kOpen = 0xffff;
    const auto atLowerGround = [&](size_t i) {
      bool lower = false;
      forEachNeighbour(i, [&](size_t next) { lower |= level[next] != kOpen; });
      return lower;
    };
    if (plateau.empty()) return;
    const int first = level[plateau.front()];
    for (const uint32_t i : plateau) level[i] = kOpen;
    std::vector<uint32_t> ring;
    for (const uint32_t i : plateau)
      if (atLowerGround(i)) ring.push_back(i);
    for (int at = first; !ring.empty(); at = std::min(at + 10, kOpen - 1)) {
      for (const uint32_t i : ring) level[i] = static_cast<uint16_t>(at);
      std::vector<uint32_t> inner;
      for (const uint32_t i : ring)
        forEachNeighbour(i, [&](size_t next) {
          if (level[next] != kOpen) return;
          level[next] = static_cast<uint16_t>(at);
          inner.push_back(static_cast<uint32_t>(next));
        });
      ring = std::move(inner);
    }
  }

  // Cells at the grid's edge have level 0 always: all others have eight neighbours.
  template <typename F>
  void forEachNeighbour(size_t cell, F f) const {
    for (const std::ptrdiff_t offset : offsets_)
      f(static_cast<size_t>(static_cast<std::ptrdiff_t>(cell) + offset));
  }

  unsigned pattern(size_t cell) const {
    unsigned pattern = 0;
    for (unsigned k = 0; k < 8; ++k)
      if (level_[static_cast<size_t>(static_cast<std::ptrdiff_t>(cell) + offsets_[k])] > 0)
        pattern |= 1U << k;
    return pattern;
  }
  bool onEdge(size_t cell) const { return (pattern(cell) & 0x55U) != 0x55U; }

  bool canGo(size_t cell) const {
    static const std::array<bool, 256> kSimple = makeSimple();
    const unsigned p = pattern(cell);
    if (!kSimple[p]) return false;
    // An end of a line stays if it lies on a ridge of the clearance.
    return !isEnd(p) || !onRidge(cell);
  }
  // One neighbour, or two that touch.
  static bool isEnd(unsigned p) {
    int count = 0, runs = 0;
    for (unsigned k = 0; k < 8; ++k) {
      count += static_cast<int>((p >> k) & 1U);
      runs += !((p >> k) & 1U) && ((p >> ((k + 1) % 8)) & 1U) ? 1 : 0;
    }
    return count == 1 || (count == 2 && runs == 1);
  }
  // The clearance rises nowhere nearly as fast as the distance: obstacles lie on opposite sides. In the
  // corner of a room it rises by 0.7 of the distance along the bisector.
  bool onRidge(size_t cell) const {
    const int x = cellX(grid_, cell), y = cellY(grid_, cell);
    constexpr int kRadius = 4;  // cells; fewer would see the steps of the grid
    for (int dy = -kRadius; dy <= kRadius; ++dy)
      for (int dx = -kRadius; dx <= kRadius; ++dx) {
        const double distance = std::hypot(dx, dy);
        if (distance < kRadius - 0.5 || distance > kRadius + 0.5 || !grid_.contains(x + dx, y + dy)) continue;
        const double rise_m = grid_.clearance_m[grid_.index(x + dx, y + dy)] - grid_.clearance_m[cell];
        if (rise_m > 0.5 * distance * grid_.cell_m) return false;
      }
    return true;
  }

  const StoreyGrid& grid_;
  double edge_m_;                            // cells at the edge of what is looked at have less clearance
  std::array<std::ptrdiff_t, 8> offsets_{};  // to the neighbours, as in kRound
  std::vector<uint16_t> level_;
};

}  // namespace

std::vector<uint32_t> medialAxis(const StoreyGrid& grid, double min_clearance_m) {
  if (grid.state.empty()) return {};
  return Thinning(grid, min_clearance_m).run();
}

}  // namespace sgraphs
