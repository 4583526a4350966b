#include "perception/free_space/storey_map.h"

#include <cmath>

#include "perception/free_space/distance_field.h"
#include "perception/free_space/island_filter.h"

namespace sgraphs {
namespace {

constexpr int kBlock = EvidenceGrid::kBlock;
constexpr int kGrowBlocks = 4;     // the grid grows by so many blocks more than it must: seldom
constexpr double kPocket_m = 0.3;  // unknown cells between rays, in the navigation grid

int64_t micrometres(double z_m) {
  return std::llround(1e6 * z_m);
}

template <typename T>
std::vector<T> moved(const std::vector<T>& old, const CellBox& from, const CellBox& to, T empty) {
  std::vector<T> out(static_cast<size_t>(to.width()) * static_cast<size_t>(to.height()), empty);
  for (int y = from.y0; y < from.y1; ++y)
    for (int x = from.x0; x < from.x1; ++x)
      out[static_cast<size_t>(y - to.y0) * static_cast<size_t>(to.width()) + static_cast<size_t>(x - to.x0)] =
          old[static_cast<size_t>(y - from.y0) * static_cast<size_t>(from.width()) +
              static_cast<size_t>(x - from.x0)];
  return out;
}

// A column's state depends on its neighbours.
std::set<EvidenceGrid::BlockKey> withNeighbours(const std::set<EvidenceGrid::BlockKey>& blocks) {
  static_assert(EvidenceGrid::kNeighbours <= kBlock);
  std::set<EvidenceGrid::BlockKey> all;
  for (const auto& [by, bx] : blocks)
    for (int y = by - 1; y <= by + 1; ++y)
      for (int x = bx - 1; x <= bx + 1; ++x) all.insert(all.end(), {y, x});
  return all;
}

}  // namespace

StoreyMap::StoreyMap(FloorId floor, const EvidenceConfig& config) : config_(config) {
  rooms_.floor = navigation_.floor = floor;
  rooms_.cell_m = navigation_.cell_m = config.cell_m;
}

bool StoreyMap::reaches(const Eigen::Vector2d& position_map) const {
  const Eigen::Vector2d cell = position_map / config_.cell_m;
  if (!(cell.cwiseAbs().maxCoeff() < kMaxCells)) return false;
  CellBox box = views_;
  const int x = static_cast<int>(std::floor(cell.x())), y = static_cast<int>(std::floor(cell.y()));
  const int around = static_cast<int>(std::ceil(2 * config_.max_range_m / config_.cell_m));
  box.include(x - around, y - around);
  box.include(x + around, y + around);
  return static_cast<double>(box.width()) * box.height() <= kMaxCells;
}

void StoreyMap::add(const KeyframeView& view, double surface_z_m, int sign) {
  views_.include(view.x0, view.y0);
  views_.include(view.x0 + view.size, view.y0 + view.size);
  evidence_.add(view, sign);
  surface_sum_um_ += sign * micrometres(surface_z_m);
  num_views_ += sign;
}

void StoreyMap::addWall(const WallTrace& trace, int sign) {
  for (const WallTrace::Piece& piece : trace.pieces)
    for (const auto& [x, y] : wallCells(piece, config_.cell_m)) evidence_.addWall(x, y, sign);
}

double StoreyMap::surface_z_m() const {
  return num_views_ == 0 ? 0.0
                         : 1e-6 * static_cast<double>(surface_sum_um_) / static_cast<double>(num_views_);
}

size_t StoreyMap::bytes() const {
  const size_t cells = rooms_.state.size();
  return evidence_.bytes() + cells * (5 * sizeof(uint8_t) + 2 * sizeof(float));
}

// The grids cover all blocks that ever held evidence, and a margin of unknown cells around them.
void StoreyMap::grow(const std::set<EvidenceGrid::BlockKey>& blocks) {
  CellBox needed = cells_;
  for (const auto& [by, bx] : blocks) {
    needed.include(bx * kBlock - 1, by * kBlock - 1);
    needed.include((bx + 1) * kBlock, (by + 1) * kBlock);
  }
  if (needed.x0 >= cells_.x0 && needed.y0 >= cells_.y0 && needed.x1 <= cells_.x1 && needed.y1 <= cells_.y1)
    return;
  const bool first = cells_.empty();
  const int more = kGrowBlocks * kBlock;
  relayout({first || needed.x0 < cells_.x0 ? needed.x0 - more : cells_.x0,
            first || needed.y0 < cells_.y0 ? needed.y0 - more : cells_.y0,
            first || needed.x1 > cells_.x1 ? needed.x1 + more : cells_.x1,
            first || needed.y1 > cells_.y1 ? needed.y1 + more : cells_.y1});
}

void StoreyMap::relayout(const CellBox& cells) {
  for (StoreyGrid* grid : {&rooms_, &navigation_}) {
    grid->state = moved(grid->state, cells_, cells, CellState::kUnknown);
    grid->clearance_m = moved(grid->clearance_m, cells_, cells, 0.0f);
    grid->width = cells.width();
    grid->height = cells.height();
    grid->origin_map = config_.cell_m * Eigen::Vector2d(cells.x0, cells.y0);
  }
  raw_rooms_ = moved(raw_rooms_, cells_, cells, CellState::kUnknown);
  raw_navigation_ = moved(raw_navigation_, cells_, cells, CellState::kUnknown);
  on_wall_ = moved(on_wall_, cells_, cells, uint8_t{0});
  cells_ = cells;
}

void StoreyMap::classifyBlock(EvidenceGrid::BlockKey key, CellBox& rooms_changed,
                              CellBox& navigation_changed) {
  const EvidenceGrid::Block* block = evidence_.find(key);
  for (int i = 0; i < kBlock * kBlock; ++i) {
    const int map_x = key.second * kBlock + i % kBlock, map_y = key.first * kBlock + i / kBlock;
    const int x = map_x - cells_.x0, y = map_y - cells_.y0;
    const size_t index = rooms_.index(x, y);
    const ColumnState state =
        block ? evidence_.state(map_x, map_y, (*block)[static_cast<size_t>(i)], config_) : ColumnState{};
    const auto on_wall = static_cast<uint8_t>(state.on_wall);
    if (raw_rooms_[index] != state.rooms || on_wall_[index] != on_wall) rooms_changed.include(x, y);
    if (raw_navigation_[index] != state.navigation) navigation_changed.include(x, y);
    raw_rooms_[index] = state.rooms;
    raw_navigation_[index] = state.navigation;
    on_wall_[index] = on_wall;
  }
}

bool StoreyMap::refresh() {
  rooms_.surface_z_m = navigation_.surface_z_m = surface_z_m();
  const std::set<EvidenceGrid::BlockKey> blocks = withNeighbours(evidence_.takeChanged());
  grow(blocks);
  CellBox rooms_changed, navigation_changed;
  for (const EvidenceGrid::BlockKey& key : blocks) classifyBlock(key, rooms_changed, navigation_changed);
  const IslandRule islands{.max_cells = static_cast<int>(std::lround(config_.max_island_m / config_.cell_m))};
  const IslandRule pockets{.max_cells = static_cast<int>(std::lround(kPocket_m / config_.cell_m)),
                           .only_unknown = true};
  rooms_changed = filterIslands(rooms_, raw_rooms_, on_wall_, rooms_changed, islands);
  navigation_changed = filterIslands(navigation_, raw_navigation_, {}, navigation_changed, pockets);
  updateClearance(rooms_, rooms_changed, config_.reach_m);
  updateClearance(navigation_, navigation_changed, config_.reach_m);
  return !rooms_changed.empty() || !navigation_changed.empty();
}

}  // namespace sgraphs
