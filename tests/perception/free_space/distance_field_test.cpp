#include "perception/free_space/distance_field.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace sgraphs {
namespace {

constexpr double kReach_m = 1.2;

StoreyGrid makeGrid(int width, int height) {
  StoreyGrid grid;
  grid.width = width;
  grid.height = height;
  grid.state.assign(static_cast<size_t>(width * height), CellState::kUnknown);
  grid.clearance_m.assign(grid.state.size(), 0.0f);
  return grid;
}

// By definition: over all cells that are not free, and those beyond the edge.
float bruteForce(const StoreyGrid& grid, int x, int y) {
  if (grid.state[grid.index(x, y)] != CellState::kFree) return 0;
  double best = kReach_m;
  for (int j = -1; j <= grid.height; ++j)
    for (int i = -1; i <= grid.width; ++i) {
      if (grid.contains(i, j) && grid.state[grid.index(i, j)] == CellState::kFree) continue;
      best = std::min(best, grid.cell_m * std::hypot(i - x, j - y));
    }
  return static_cast<float>(best);
}

class Sequence {
 public:
  int next(int below) {
    state_ = state_ * 6364136223846793005ull + 1442695040888963407ull;
    return static_cast<int>((state_ >> 33) % static_cast<uint64_t>(below));
  }

 private:
  uint64_t state_ = 7;
};

void expectExact(const StoreyGrid& grid) {
  for (int y = 0; y < grid.height; ++y)
    for (int x = 0; x < grid.width; ++x)
      ASSERT_NEAR(grid.clearance_m[grid.index(x, y)], bruteForce(grid, x, y), 1e-5) << x << ", " << y;
}

TEST(DistanceFieldTest, EqualsBruteForceAfterAnySequenceOfUpdates) {
  StoreyGrid grid = makeGrid(61, 47);
  Sequence random;
  for (int step = 0; step < 30; ++step) {
    // A rectangle becomes free, or is seen to be no longer; then a few cells change.
    CellBox changed;
    const int x0 = random.next(60), y0 = random.next(46), w = 1 + random.next(30), h = 1 + random.next(20);
    const CellState state = step % 3 == 2 ? CellState::kObstacle : CellState::kFree;
    for (int y = y0; y < std::min(y0 + h, grid.height); ++y)
      for (int x = x0; x < std::min(x0 + w, grid.width); ++x) {
        grid.state[grid.index(x, y)] = random.next(40) == 0 ? CellState::kObstacle : state;
        changed.include(x, y);
      }
    updateClearance(grid, changed, kReach_m);
    expectExact(grid);
  }
}

TEST(DistanceFieldTest, EqualsFullRecomputationBitByBit) {
  StoreyGrid grid = makeGrid(80, 80);
  Sequence random;
  for (int step = 0; step < 200; ++step) {
    const int x = random.next(80), y = random.next(80);
    grid.state[grid.index(x, y)] = random.next(5) == 0 ? CellState::kObstacle : CellState::kFree;
    updateClearance(grid, {x, y, x + 1, y + 1}, kReach_m);
  }
  StoreyGrid anew = grid;
  std::fill(anew.clearance_m.begin(), anew.clearance_m.end(), -1.0f);
  updateClearance(anew, {0, 0, 80, 80}, kReach_m);
  EXPECT_EQ(grid.clearance_m, anew.clearance_m);
}

TEST(DistanceFieldTest, ReachEndsIt) {
  StoreyGrid grid = makeGrid(60, 60);
  std::fill(grid.state.begin(), grid.state.end(), CellState::kFree);
  updateClearance(grid, {0, 0, 60, 60}, kReach_m);
  EXPECT_FLOAT_EQ(grid.clearance_m[grid.index(30, 30)], static_cast<float>(kReach_m));
  EXPECT_FLOAT_EQ(grid.clearance_m[grid.index(0, 30)], 0.1f) << "beyond the edge nothing is free";
}

TEST(DistanceFieldTest, NothingChangedNothingTouched) {
  StoreyGrid grid = makeGrid(10, 10);
  std::fill(grid.clearance_m.begin(), grid.clearance_m.end(), 7.0f);
  updateClearance(grid, {}, kReach_m);
  EXPECT_EQ(grid.clearance_m, std::vector<float>(100, 7.0f));
}

}  // namespace
}  // namespace sgraphs
