#include "perception/free_space/clusters/axis_graph.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>

#include "perception/free_space/clusters/cell_labels.h"
#include "perception/free_space/clusters/medial_axis.h"

namespace sgraphs {
namespace {

constexpr double kMerge_m = 0.35;  // special places nearer than this are one

class AxisWalk {
 public:
  AxisWalk(const StoreyGrid& grid, const FreeSpaceGraphConfig& config)
      : grid_(grid),
        config_(config),
        // What keepsClear cannot vouch for is left out: between the centres of cells it loses 0.7 of a cell.
        axis_(medialAxis(grid, config.edge_clearance_m + 0.85 * grid.cell_m)),
        slot_(grid.state.size(), -1) {
    for (size_t i = 0; i < axis_.size(); ++i) slot_[axis_[i]] = static_cast<int32_t>(i);
  }

  AxisGraph run(const std::vector<Eigen::Vector2d>& wanted) {
    std::vector<uint32_t> seeds = specialPlaces(wanted);
    // Where a straight line does not keep clear, the axis bends: a vertex more there.
    for (int round = 0; round < 4; ++round) {
      flood(seeds);
      const std::vector<uint32_t> bends = connect();
      if (bends.empty()) break;
      seeds.clear();
      for (const auto& vertex : graph_.vertices) seeds.push_back(vertex.cell);
      seeds.insert(seeds.end(), bends.begin(), bends.end());
    }
    return std::move(graph_);
  }

 private:
  template <typename F>
  void forEachNeighbour(size_t i, F f) const {
    const int x = cellX(grid_, axis_[i]), y = cellY(grid_, axis_[i]);
    for (const CellStep& step : kCellSteps) {
      if (!grid_.contains(x + step.x, y + step.y)) continue;
      const int32_t next = slot_[grid_.index(x + step.x, y + step.y)];
      if (next >= 0) f(static_cast<size_t>(next), step.x != 0 && step.y != 0);
    }
  }

  // Branches that leave a cell: parts of its ring of neighbours that lie on the axis.
  int branches(size_t i) const {
    static constexpr CellStep kRound[8] = {{1, 0},  {1, 1},   {0, 1},  {-1, 1},
                                           {-1, 0}, {-1, -1}, {0, -1}, {1, -1}};
    const int x = cellX(grid_, axis_[i]), y = cellY(grid_, axis_[i]);
    bool on[8];
    for (int k = 0; k < 8; ++k) {
      const int nx = x + kRound[k].x, ny = y + kRound[k].y;
      on[k] = grid_.contains(nx, ny) && slot_[grid_.index(nx, ny)] >= 0;
    }
    int count = 0;
    for (int k = 0; k < 8; ++k) count += !on[k] && on[(k + 1) % 8] ? 1 : 0;
    return count;
  }

  std::vector<uint32_t> specialPlaces(const std::vector<Eigen::Vector2d>& wanted) const {
    std::vector<uint32_t> places;
    const auto add = [&](uint32_t cell) {
      for (const uint32_t other : places)
        if ((centerOf(grid_, other) - centerOf(grid_, cell)).norm() < kMerge_m) return;
      places.push_back(cell);
    };
    for (const Eigen::Vector2d& p : wanted) {
      uint32_t best = 0;
      double best_m = 0.5;
      for (const uint32_t cell : axis_) {
        const double d_m = (centerOf(grid_, cell) - p).norm();
        if (d_m >= best_m) continue;
        best_m = d_m;
        best = cell;
      }
      if (best_m < 0.5) add(best);
    }
    std::vector<std::pair<int, uint32_t>> ranked;
    for (size_t i = 0; i < axis_.size(); ++i) {
      const int n = branches(i);
      if (n >= 3) ranked.emplace_back(-n, axis_[i]);
      if (n <= 1) ranked.emplace_back(0, axis_[i]);
    }
    std::sort(ranked.begin(), ranked.end());
    for (const auto& [rank, cell] : ranked) add(cell);
    return places;
  }

  // From all seeds along the axis at once; a cell as far as the spacing from its vertex is a vertex itself.
  void flood(const std::vector<uint32_t>& seeds) {
    using Front = std::pair<double, size_t>;
    std::priority_queue<Front, std::vector<Front>, std::greater<>> open;
    graph_.vertices.clear();
    owner_.assign(axis_.size(), -1);
    std::vector<double> distance_m(axis_.size(), std::numeric_limits<double>::max());
    const auto plant = [&](size_t i) {
      owner_[i] = static_cast<int32_t>(graph_.vertices.size());
      distance_m[i] = 0;
      graph_.vertices.push_back({axis_[i], {}});
    };
    for (const uint32_t cell : seeds) {
      const auto i = static_cast<size_t>(slot_[cell]);
      if (owner_[i] >= 0) continue;
      plant(i);
      open.emplace(0.0, i);
    }
    // Fronts from both sides leave gaps of up to twice the step.
    const double step_m = 0.65 * config_.vertex_spacing_m;
    std::vector<uint8_t> done(axis_.size(), 0);
    while (!open.empty()) {
      const size_t i = open.top().second;
      open.pop();
      if (done[i]) continue;
      done[i] = 1;
      if (distance_m[i] >= step_m && !touchesOther(i)) plant(i);
      forEachNeighbour(i, [&](size_t next, bool diagonal) {
        const double d_m = distance_m[i] + (diagonal ? M_SQRT2 : 1.0) * grid_.cell_m;
        if (done[next] || d_m >= distance_m[next]) return;
        distance_m[next] = d_m;
        owner_[next] = owner_[i];
        open.emplace(d_m, next);
      });
    }
  }

  bool touchesOther(size_t i) const {
    bool other = false;
    forEachNeighbour(i, [&](size_t next, bool) { other |= owner_[next] >= 0 && owner_[next] != owner_[i]; });
    return other;
  }

  // Edges where the floods of two vertices meet; returns where a line is not clear.
  std::vector<uint32_t> connect() {
    std::set<std::pair<int32_t, int32_t>> joined;
    std::vector<std::pair<std::pair<int32_t, int32_t>, uint32_t>> failed;
    for (size_t i = 0; i < axis_.size(); ++i)
      forEachNeighbour(i, [&](size_t next, bool) {
        const int32_t a = owner_[i], b = owner_[next];
        if (a < 0 || b <= a || joined.count({a, b})) return;
        auto& va = graph_.vertices[static_cast<size_t>(a)];
        auto& vb = graph_.vertices[static_cast<size_t>(b)];
        if (keepsClear(grid_, centerOf(grid_, va.cell), centerOf(grid_, vb.cell), config_.edge_clearance_m)) {
          joined.insert({a, b});
          va.neighbours.insert(static_cast<size_t>(b));
          vb.neighbours.insert(static_cast<size_t>(a));
        } else {
          failed.push_back({{a, b}, axis_[i]});
        }
      });
    std::vector<uint32_t> bends;
    for (const auto& [pair, cell] : failed) {
      const uint32_t ends[2] = {graph_.vertices[static_cast<size_t>(pair.first)].cell,
                                graph_.vertices[static_cast<size_t>(pair.second)].cell};
      if (!joined.count(pair) && cell != ends[0] && cell != ends[1]) bends.push_back(cell);
    }
    return bends;
  }

  const StoreyGrid& grid_;
  const FreeSpaceGraphConfig& config_;
  std::vector<uint32_t> axis_;
  std::vector<int32_t> slot_;   // index in axis_, by cell
  std::vector<int32_t> owner_;  // index of the nearest vertex along the axis
  AxisGraph graph_;
};

}  // namespace

bool keepsClear(const StoreyGrid& grid, const Eigen::Vector2d& a, const Eigen::Vector2d& b,
                double clearance_m) {
  const double spacing_m = 0.25 * grid.cell_m;
  const int steps = std::max(1, static_cast<int>(std::ceil((b - a).norm() / spacing_m)));
  for (int s = 0; s <= steps; ++s) {
    const Eigen::Vector2d p = a + (b - a) * s / steps;
    // Clearance falls by no more than the distance from the cell's centre.
    const CellStep low = cellAt(grid, p - Eigen::Vector2d::Constant(0.5 * grid.cell_m));
    double bound_m = 0;
    for (int k = 0; k < 4; ++k) {
      const int x = low.x + k % 2, y = low.y + k / 2;
      if (stateAt(grid, x, y) != CellState::kFree) continue;
      bound_m = std::max(bound_m, grid.clearance_m[grid.index(x, y)] - (p - grid.center(x, y)).norm());
    }
    if (bound_m < clearance_m + 0.5 * spacing_m) return false;
  }
  return true;
}

AxisGraph graphAlongAxis(const StoreyGrid& navigation, const std::vector<Eigen::Vector2d>& wanted,
                         const FreeSpaceGraphConfig& config) {
  return AxisWalk(navigation, config).run(wanted);
}

}  // namespace sgraphs
