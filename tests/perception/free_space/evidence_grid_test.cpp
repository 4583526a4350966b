#include "perception/free_space/evidence_grid.h"

#include <gtest/gtest.h>

namespace sgraphs {
namespace {

const EvidenceConfig kConfig;

// Hits and misses of slices [first, last].
ColumnVotes votesOf(int first, int last, uint16_t hits, uint16_t misses) {
  ColumnVotes votes;
  for (auto i = static_cast<size_t>(first); i <= static_cast<size_t>(last); ++i) {
    votes.hits[i] = hits;
    votes.misses[i] = misses;
  }
  return votes;
}

ColumnVotes operator+(ColumnVotes a, const ColumnVotes& b) {
  for (size_t i = 0; i < a.hits.size(); ++i) {
    a.hits[i] = static_cast<uint16_t>(a.hits[i] + b.hits[i]);
    a.misses[i] = static_cast<uint16_t>(a.misses[i] + b.misses[i]);
  }
  return a;
}

TEST(ColumnTest, NothingSeenIsUnknown) {
  const ColumnState state = classify({}, false, kConfig);
  EXPECT_EQ(state.rooms, CellState::kUnknown);
  EXPECT_EQ(state.navigation, CellState::kUnknown);
}

TEST(ColumnTest, DeskIsFreeForRoomsAndInTheWayForRobots) {
  const ColumnState state = classify(votesOf(0, 3, 3, 0) + votesOf(4, 7, 0, 5), false, kConfig);
  EXPECT_EQ(state.rooms, CellState::kFree);
  EXPECT_EQ(state.navigation, CellState::kObstacle);
}

TEST(ColumnTest, WallSeenFromNearbyIsOneThoughItsUpperPartIsNot) {
  const ColumnState state = classify(votesOf(2, 4, 2, 0), false, kConfig);
  EXPECT_EQ(state.rooms, CellState::kObstacle);
  EXPECT_EQ(state.navigation, CellState::kObstacle);
}

TEST(ColumnTest, LowCabinetHasMoreFreeThanOccupiedAboveIt) {
  EXPECT_EQ(classify(votesOf(0, 5, 3, 0) + votesOf(6, 8, 0, 3), false, kConfig).rooms, CellState::kFree);
  EXPECT_EQ(classify(votesOf(0, 6, 3, 0) + votesOf(7, 8, 0, 3), false, kConfig).rooms, CellState::kObstacle);
}

TEST(ColumnTest, WhatHangsAboveAFreePlaceIsInNobodysWay) {
  const ColumnState gone = classify(votesOf(0, 4, 1, 3) + votesOf(5, 8, 1, 0), false, kConfig);
  EXPECT_EQ(gone.rooms, CellState::kFree);
  EXPECT_EQ(gone.navigation, CellState::kFree);
  EXPECT_EQ(classify(votesOf(4, 4, 0, 3) + votesOf(5, 8, 1, 0), false, kConfig).rooms, CellState::kObstacle)
      << "it may reach down";
}

TEST(ColumnTest, MoreMissesThanHitsClearIt) {
  EXPECT_EQ(classify(votesOf(0, 8, 3, 2), false, kConfig).rooms, CellState::kObstacle);
  EXPECT_EQ(classify(votesOf(0, 8, 2, 3), false, kConfig).rooms, CellState::kFree);
  EXPECT_EQ(classify(votesOf(0, 8, 2, 3), true, kConfig).rooms, CellState::kObstacle) << "a pane";
}

TEST(ColumnTest, WhereTheRobotWentNothingStands) {
  ColumnVotes votes = votesOf(0, 8, 9, 0);
  votes.walked = 1;
  EXPECT_EQ(classify(votes, false, kConfig).rooms, CellState::kFree);
  EXPECT_EQ(classify(votes, false, kConfig).navigation, CellState::kFree);
}

// A view with one bit pattern in a rectangle of columns of the map.
KeyframeView viewOf(int x0, int y0, int x1, int y1, uint16_t hits, uint16_t misses) {
  KeyframeView view;
  view.x0 = -40;
  view.y0 = -40;
  view.size = 80;
  view.hits.assign(6400, 0);
  view.misses.assign(6400, 0);
  view.walked.assign(6400, 0);
  for (int y = y0; y <= y1; ++y)
    for (int x = x0; x <= x1; ++x) {
      view.hits[view.index(x + 40, y + 40)] = hits;
      view.misses[view.index(x + 40, y + 40)] = misses;
    }
  return view;
}

TEST(EvidenceGridTest, TakingBackLeavesNothing) {
  EvidenceGrid grid;
  const KeyframeView one = viewOf(-33, -5, -2, 30, 0b101, 0b010), other = viewOf(-10, -10, 10, 10, 0, 0b111);
  grid.add(one, +1);
  grid.add(other, +1);
  const ColumnVotes both = grid.at(-5, 5);
  EXPECT_EQ(both.hits[0], 1);
  EXPECT_EQ(both.misses[1], 2);
  grid.add(one, -1);
  EXPECT_EQ(grid.at(-5, 5).hits[0], 0);
  EXPECT_EQ(grid.at(-5, 5).misses[1], 1);
  EXPECT_EQ(grid.at(-33, 20), ColumnVotes{});
  grid.add(other, -1);
  grid.takeChanged();
  EXPECT_EQ(grid.numBlocks(), 0u);
}

// A mapped wall along y = 0, hit in few keyframes and seen through in many.
EvidenceGrid paneGrid(int hits, int misses) {
  EvidenceGrid grid;
  for (int x = -20; x <= 20; ++x) grid.addWall(x, 0, +1);
  for (int i = 0; i < hits; ++i) grid.add(viewOf(-20, 0, 20, 0, 0b001111100, 0), +1);
  for (int i = 0; i < misses; ++i) grid.add(viewOf(-30, -10, 30, 10, 0, 0b111111111), +1);
  return grid;
}

TEST(EvidenceGridTest, PaneOfAWallStays) {
  const EvidenceGrid grid = paneGrid(2, 20);
  EXPECT_EQ(grid.state(5, 0, grid.at(5, 0), kConfig).rooms, CellState::kObstacle);
  EXPECT_EQ(grid.state(5, 3, grid.at(5, 3), kConfig).rooms, CellState::kFree);
}

TEST(EvidenceGridTest, WhoeverWalksThroughTheDoorOfAWallLeavesNothing) {
  EvidenceGrid grid = paneGrid(0, 20);
  for (int i = 0; i < 2; ++i) grid.add(viewOf(3, -8, 7, 8, 0b111111111, 0), +1);
  EXPECT_EQ(grid.state(5, 0, grid.at(5, 0), kConfig).rooms, CellState::kFree);
}

}  // namespace
}  // namespace sgraphs
