#include "perception/free_space/island_filter.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

namespace sgraphs {
namespace {

// '.' free, '#' obstacle, '?' unknown; the first row is the lowest.
StoreyGrid gridOf(const std::vector<std::string>& rows) {
  StoreyGrid grid;
  grid.width = static_cast<int>(rows.front().size());
  grid.height = static_cast<int>(rows.size());
  for (const std::string& row : rows)
    for (const char c : row)
      grid.state.push_back(c == '.'   ? CellState::kFree
                           : c == '#' ? CellState::kObstacle
                                      : CellState::kUnknown);
  return grid;
}

std::vector<std::string> rowsOf(const StoreyGrid& grid) {
  std::vector<std::string> rows;
  for (int y = 0; y < grid.height; ++y) {
    rows.emplace_back();
    for (int x = 0; x < grid.width; ++x) {
      const CellState state = grid.state[grid.index(x, y)];
      rows.back() += state == CellState::kFree ? '.' : state == CellState::kObstacle ? '#' : '?';
    }
  }
  return rows;
}

std::vector<std::string> filtered(const std::vector<std::string>& rows, const IslandRule& rule,
                                  const std::vector<uint8_t>& keep = {}) {
  const StoreyGrid raw = gridOf(rows);
  StoreyGrid grid = raw;
  filterIslands(grid, raw.state, keep, {0, 0, grid.width, grid.height}, rule);
  return rowsOf(grid);
}

TEST(IslandFilterTest, ColumnWithItsUnknownInsideBecomesFree) {
  const std::vector<std::string> rows{"########", "#......#", "#.###..#", "#.#?#..#",
                                      "#.###..#", "#......#", "########"};
  EXPECT_EQ(filtered(rows, {.max_cells = 3}),
            (std::vector<std::string>{"########", "#......#", "#......#", "#......#", "#......#", "#......#",
                                      "########"}));
  EXPECT_EQ(filtered(rows, {.max_cells = 2}), rows);
}

TEST(IslandFilterTest, WhatTouchesAWallStays) {
  const std::vector<std::string> rows{"#######", "#.....#", "#.##..#", "#...###", "#######"};
  EXPECT_EQ(filtered(rows, {.max_cells = 3}), rows) << "corner to corner is a touch";
}

TEST(IslandFilterTest, OnlyPocketsOfUnknownIfAskedSo) {
  const std::vector<std::string> rows{"#######", "#.....#", "#..?..#", "#.....#",
                                      "#.#...#", "#.?...#", "#.....#", "#######"};
  EXPECT_EQ(filtered(rows, {.max_cells = 3, .only_unknown = true}),
            (std::vector<std::string>{"#######", "#.....#", "#.....#", "#.....#", "#.#...#", "#.?...#",
                                      "#.....#", "#######"}));
}

TEST(IslandFilterTest, KeptCellsKeepTheirIsland) {
  const std::vector<std::string> rows{"#######", "#.....#", "#.##..#", "#.....#", "#######"};
  std::vector<uint8_t> keep(35, 0);
  keep[2 * 7 + 3] = 1;
  EXPECT_EQ(filtered(rows, {.max_cells = 3}, keep), rows);
}

TEST(IslandFilterTest, ChangeByChangeEqualsTheWhole) {
  constexpr int kSize = 70;
  StoreyGrid raw;
  raw.width = raw.height = kSize;
  raw.state.assign(kSize * kSize, CellState::kUnknown);
  StoreyGrid grid = raw;
  const IslandRule rule{.max_cells = 5};
  uint64_t seed = 3;
  auto next = [&seed](int below) {
    seed = seed * 6364136223846793005ull + 1442695040888963407ull;
    return static_cast<int>((seed >> 33) % static_cast<uint64_t>(below));
  };
  for (int step = 0; step < 300; ++step) {
    CellBox changed;
    const int x0 = 1 + next(kSize - 12), y0 = 1 + next(kSize - 12), size = 1 + next(10);
    const CellState state = next(3) == 0 ? CellState::kObstacle : CellState::kFree;
    for (int y = y0; y < y0 + size; ++y)
      for (int x = x0; x < x0 + size; ++x) {
        raw.state[raw.index(x, y)] = state;
        changed.include(x, y);
      }
    const StoreyGrid before = grid;
    const CellBox differs = filterIslands(grid, raw.state, {}, changed, rule);
    for (int y = 0; y < kSize; ++y)
      for (int x = 0; x < kSize; ++x)
        ASSERT_TRUE(grid.state[grid.index(x, y)] == before.state[grid.index(x, y)] || differs.contains(x, y));
    StoreyGrid whole = raw;
    filterIslands(whole, raw.state, {}, {0, 0, kSize, kSize}, rule);
    ASSERT_EQ(rowsOf(grid), rowsOf(whole)) << "step " << step;
  }
}

}  // namespace
}  // namespace sgraphs
