#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <set>
#include <unordered_map>
#include <utility>

#include "perception/free_space/evidence_config.h"
#include "perception/free_space/ray_caster.h"
#include "perception/free_space/storey_grid.h"

namespace sgraphs {

// Sums over keyframes of what they say of a column. Adding and taking back the same view leaves no trace.
struct ColumnVotes {
  std::array<uint16_t, kNumSlices> hits{};
  std::array<uint16_t, kNumSlices> misses{};
  uint16_t walked = 0;
  uint16_t walls = 0;  // mapped walls that pass here

  bool operator==(const ColumnVotes&) const = default;
};

// What a column's votes amount to.
struct ColumnState {
  CellState rooms = CellState::kUnknown;       // as it divides rooms: furniture is free
  CellState navigation = CellState::kUnknown;  // as a robot meets it
  bool on_wall = false;                        // an obstacle of a mapped wall
};

// `is_pane`: the column lies on a mapped wall that rays may pass, so few hits weigh much.
ColumnState classify(const ColumnVotes& votes, bool is_pane, const EvidenceConfig& config);

// Evidence of one storey: columns in hashed blocks, which exist where anything was seen.
class EvidenceGrid {
 public:
  static constexpr int kBlock = 16;      // columns along an edge
  static constexpr int kNeighbours = 4;  // columns
  using BlockKey = std::pair<int, int>;  // y, x [blocks]
  using Block = std::array<ColumnVotes, kBlock * kBlock>;

  // Adds a keyframe's view (sign 1) or takes it back (sign -1).
  void add(const KeyframeView& view, int sign);
  void addWall(int x, int y, int sign);

  // Blocks changed since the last call, in order; empty ones are given up here.
  std::set<BlockKey> takeChanged();

  const Block* find(BlockKey key) const;
  ColumnVotes at(int x, int y) const;
  // The column as it looks among its neighbours, up to kNeighbours columns away.
  ColumnState state(int x, int y, const ColumnVotes& votes, const EvidenceConfig& config) const;
  size_t numBlocks() const { return blocks_.size(); }
  size_t bytes() const { return blocks_.size() * (sizeof(Block) + 64); }

 private:
  struct Hash {
    size_t operator()(const BlockKey& key) const {
      const auto bits =
          (static_cast<uint64_t>(static_cast<uint32_t>(key.first)) << 32) | static_cast<uint32_t>(key.second);
      return static_cast<size_t>((bits * 0x9E3779B97F4A7C15ull) >> 20);
    }
  };
  Block& touch(BlockKey key);
  bool isTrail(int x, int y, const ColumnVotes& votes) const;

  std::unordered_map<BlockKey, std::unique_ptr<Block>, Hash> blocks_;  // looked up, never iterated
  std::set<BlockKey> changed_;
};

}  // namespace sgraphs
