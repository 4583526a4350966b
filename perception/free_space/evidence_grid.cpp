#include "perception/free_space/evidence_grid.h"

#include <algorithm>
#include <bit>
#include <numeric>

namespace sgraphs {
namespace {

// From here up (1.1 m over the walking surface) it is walls, doors, cabinets and people that stand in the
// way.
constexpr int kFirstUpperSlice = 5;
constexpr unsigned kAll = (1u << kNumSlices) - 1;
// 0.7 to 1.1 m: seen from anywhere, and more than desks reach.
constexpr unsigned kMiddle = (1u << 3) | (1u << 4);
constexpr unsigned kUpper = kAll & ~((1u << kFirstUpperSlice) - 1);

constexpr int kTrail = 3;  // hits on a wall per hit beside it, at most, where somebody walked through

int numHits(const ColumnVotes& votes) {
  return std::accumulate(votes.hits.begin(), votes.hits.end(), 0);
}

int floorDiv(int a, int b) {
  return a >= 0 ? a / b : -((b - 1 - a) / b);
}

CellState stateOf(bool is_obstacle, bool is_free) {
  if (is_obstacle) return CellState::kObstacle;
  return is_free ? CellState::kFree : CellState::kUnknown;
}

void vote(ColumnVotes& column, unsigned hits, unsigned misses, bool walked, int sign) {
  const auto one = static_cast<uint16_t>(sign);
  for (; hits; hits &= hits - 1) column.hits[static_cast<size_t>(std::countr_zero(hits))] += one;
  for (; misses; misses &= misses - 1) column.misses[static_cast<size_t>(std::countr_zero(misses))] += one;
  if (walked) column.walked += one;
}

}  // namespace

ColumnState classify(const ColumnVotes& votes, bool is_pane, const EvidenceConfig& config) {
  if (votes.walked > 0) return {CellState::kFree, CellState::kFree, false};
  const double misses_per_hit = is_pane ? config.misses_per_wall_hit : config.misses_per_hit;
  unsigned occupied = 0, free = 0;
  for (int i = 0; i < kNumSlices; ++i) {
    const auto slice = static_cast<size_t>(i);
    if (votes.hits[slice] * misses_per_hit > votes.misses[slice])
      occupied |= 1u << i;
    else if (votes.misses[slice] > 0)
      free |= 1u << i;
  }
  // What hangs above a place that was seen free is in nobody's way; most often somebody stood there, and the
  // LiDAR has since come too near to see the upper part again.
  if ((free & kMiddle) == kMiddle) {
    free |= occupied & kUpper;
    occupied &= ~kUpper;
  }
  const int upper_occupied = std::popcount(occupied & kUpper), upper_free = std::popcount(free & kUpper);
  ColumnState state;
  state.on_wall = votes.walls > 0 && occupied != 0;
  const bool tall = upper_occupied > 0 && upper_occupied >= upper_free;
  const bool low_under_unseen = occupied != 0 && upper_occupied + upper_free == 0;
  state.rooms = stateOf(state.on_wall || tall || low_under_unseen, free != 0 || occupied != 0);
  state.navigation = stateOf(occupied != 0, free != 0);
  return state;
}

EvidenceGrid::Block& EvidenceGrid::touch(BlockKey key) {
  changed_.insert(key);
  std::unique_ptr<Block>& block = blocks_[key];
  if (!block) block = std::make_unique<Block>();
  return *block;
}

void EvidenceGrid::add(const KeyframeView& view, int sign) {
  const int y_end = view.y0 + view.size, x_end = view.x0 + view.size;
  for (int by = floorDiv(view.y0, kBlock); by * kBlock < y_end; ++by)
    for (int bx = floorDiv(view.x0, kBlock); bx * kBlock < x_end; ++bx) {
      Block* block = nullptr;
      for (int y = std::max(by * kBlock, view.y0); y < std::min((by + 1) * kBlock, y_end); ++y)
        for (int x = std::max(bx * kBlock, view.x0); x < std::min((bx + 1) * kBlock, x_end); ++x) {
          const size_t i = view.index(x - view.x0, y - view.y0);
          if (!(view.hits[i] | view.misses[i] | view.walked[i])) continue;
          if (!block) block = &touch({by, bx});
          ColumnVotes& column = (*block)[static_cast<size_t>((y - by * kBlock) * kBlock + x - bx * kBlock)];
          vote(column, view.hits[i], view.misses[i], view.walked[i] != 0, sign);
        }
    }
}

void EvidenceGrid::addWall(int x, int y, int sign) {
  const BlockKey key{floorDiv(y, kBlock), floorDiv(x, kBlock)};
  Block& block = touch(key);
  block[static_cast<size_t>((y - key.first * kBlock) * kBlock + x - key.second * kBlock)].walls +=
      static_cast<uint16_t>(sign);
}

std::set<EvidenceGrid::BlockKey> EvidenceGrid::takeChanged() {
  std::set<BlockKey> changed;
  changed.swap(changed_);
  for (const BlockKey& key : changed) {
    const auto it = blocks_.find(key);
    const bool is_empty = std::all_of(it->second->begin(), it->second->end(),
                                      [](const ColumnVotes& votes) { return votes == ColumnVotes{}; });
    if (is_empty) blocks_.erase(it);
  }
  return changed;
}

const EvidenceGrid::Block* EvidenceGrid::find(BlockKey key) const {
  const auto it = blocks_.find(key);
  return it == blocks_.end() ? nullptr : it->second.get();
}

ColumnVotes EvidenceGrid::at(int x, int y) const {
  const BlockKey key{floorDiv(y, kBlock), floorDiv(x, kBlock)};
  const Block* block = find(key);
  if (!block) return {};
  return (*block)[static_cast<size_t>((y - key.first * kBlock) * kBlock + x - key.second * kBlock)];
}

// Somebody walked through a wall here, so there is a door: what was hit on the wall was hit on both sides of
// it, too. A pane has nothing in front of it.
bool EvidenceGrid::isTrail(int x, int y, const ColumnVotes& votes) const {
  constexpr std::array<std::array<int, 2>, 8> kDirections{
      {{4, 0}, {4, 2}, {3, 3}, {2, 4}, {0, 4}, {-2, 4}, {-3, 3}, {-4, 2}}};
  auto hitsBeside = [&](int dx, int dy) {
    const ColumnVotes beside = at(x + dx, y + dy);
    return beside.walls > 0 ? 0 : numHits(beside);
  };
  for (const auto& [dx, dy] : kDirections)
    if (kTrail * std::min(hitsBeside(dx, dy), hitsBeside(-dx, -dy)) >= numHits(votes)) return true;
  return false;
}

ColumnState EvidenceGrid::state(int x, int y, const ColumnVotes& votes, const EvidenceConfig& config) const {
  const ColumnState plain = classify(votes, false, config);
  const bool asks = votes.walls > 0 && plain.rooms == CellState::kFree && numHits(votes) > 0;
  return asks && !isTrail(x, y, votes) ? classify(votes, true, config) : plain;
}

}  // namespace sgraphs
