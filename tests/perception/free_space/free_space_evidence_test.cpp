#include "perception/free_space/free_space_evidence.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/perception/free_space/box_world.h"

namespace sgraphs {
namespace {

const StoreyGrid& rooms(const FreeSpaceEvidence& evidence, int64_t floor = 0) {
  return evidence.storeys().at(FloorId{floor}).rooms();
}
const StoreyGrid& navigation(const FreeSpaceEvidence& evidence, int64_t floor = 0) {
  return evidence.storeys().at(FloorId{floor}).navigation();
}

CellState stateAt(const StoreyGrid& grid, double x, double y) {
  const int cx = static_cast<int>(std::floor((x - grid.origin_map.x()) / grid.cell_m));
  const int cy = static_cast<int>(std::floor((y - grid.origin_map.y()) / grid.cell_m));
  return grid.contains(cx, cy) ? grid.state[grid.index(cx, cy)] : CellState::kUnknown;
}

int count(const StoreyGrid& grid, CellState state) {
  return static_cast<int>(std::count(grid.state.begin(), grid.state.end(), state));
}

void look(FreeSpaceEvidence& evidence, const BoxWorld& world, int64_t id, const SE3& T_map_body,
          int64_t floor = 0) {
  evidence.step(world.keyframe(id, T_map_body), updateOf({mapKeyframe(id, T_map_body, floor)}));
}

BoxWorld boxRoom() {
  BoxWorld world;
  world.addRoom({-3.03, -2.04}, {3.04, 2.03});
  return world;
}

// The sums of every column, for comparison.
std::vector<ColumnVotes> allVotes(const FreeSpaceEvidence& evidence, int64_t floor = 0) {
  std::vector<ColumnVotes> votes;
  const EvidenceGrid& grid = evidence.storeys().at(FloorId{floor}).evidence();
  for (int y = -200; y < 200; ++y)
    for (int x = -200; x < 200; ++x) votes.push_back(grid.at(x, y));
  return votes;
}

TEST(FreeSpaceEvidenceTest, BoxRoomIsFreeWithinItsWallsAndUnknownBeyond) {
  FreeSpaceEvidence evidence{EvidenceConfig{}};
  const BoxWorld world = boxRoom();
  look(evidence, world, 0, bodyAt(-1.0, -0.5));
  look(evidence, world, 1, bodyAt(1.0, 0.5, 0.7));
  const StoreyGrid& grid = rooms(evidence);
  for (double y = -2.45; y < 2.5; y += 0.1)
    for (double x = -3.45; x < 3.5; x += 0.1) {
      const bool inside = x > -2.95 && x < 2.95 && y > -1.95 && y < 1.95;
      const bool outside = x < -3.15 || x > 3.15 || y < -2.15 || y > 2.15;
      if (!inside && !outside) continue;
      EXPECT_EQ(stateAt(grid, x, y), inside ? CellState::kFree : CellState::kUnknown) << x << ", " << y;
    }
  for (double y = -1.95; y < 2; y += 0.1) {
    EXPECT_EQ(stateAt(grid, -3.05, y), CellState::kObstacle) << y;
    EXPECT_EQ(stateAt(grid, 3.05, y), CellState::kObstacle) << y;
  }
  EXPECT_NEAR(grid.surface_z_m, 0.0, 0.02);
}

TEST(FreeSpaceEvidenceTest, ClearanceIsThatOfTheNearestWall) {
  FreeSpaceEvidence evidence{EvidenceConfig{}};
  look(evidence, boxRoom(), 0, bodyAt(0, 0));
  look(evidence, boxRoom(), 1, bodyAt(0.5, 0.5));
  const StoreyGrid& grid = rooms(evidence);
  const int x = static_cast<int>(std::floor((0.55 - grid.origin_map.x()) / 0.1));
  const int y = static_cast<int>(std::floor((0.55 - grid.origin_map.y()) / 0.1));
  EXPECT_NEAR(grid.clearance_m[grid.index(x, y)], 2.03 - 0.55, 0.1);
}

TEST(FreeSpaceEvidenceTest, FurnitureDoesNotDivideRoomsButIsInTheWay) {
  FreeSpaceEvidence evidence{EvidenceConfig{}};
  BoxWorld world = boxRoom();
  world.add({1.03, -2.04, 0}, {1.8, 0.5, 0.74});
  look(evidence, world, 0, bodyAt(-1.5, -0.5));
  look(evidence, world, 1, bodyAt(-1.0, 1.2));
  EXPECT_EQ(stateAt(rooms(evidence), 1.05, -0.5), CellState::kFree);
  EXPECT_EQ(stateAt(navigation(evidence), 1.05, -0.5), CellState::kObstacle);
}

TEST(FreeSpaceEvidenceTest, ColumnIsFilledForRoomsOnly) {
  FreeSpaceEvidence evidence{EvidenceConfig{}};
  BoxWorld world = boxRoom();
  world.add({0.8, -0.2, 0}, {1.2, 0.2, 2.6});
  for (int i = 0; i < 6; ++i) look(evidence, world, i, bodyAt(1.0 + 1.5 * std::cos(i), 1.4 * std::sin(i)));
  EXPECT_EQ(stateAt(rooms(evidence), 1.0, 0.0), CellState::kFree);
  EXPECT_NE(stateAt(navigation(evidence), 0.82, 0.0), CellState::kFree);
  EXPECT_NE(stateAt(navigation(evidence), 1.18, 0.0), CellState::kFree);
}

TEST(FreeSpaceEvidenceTest, PersonWhoLeavesIsForgotten) {
  FreeSpaceEvidence evidence{EvidenceConfig{}};
  BoxWorld crowded = boxRoom();
  crowded.add({1.34, 0.43, 0}, {1.74, 0.83, 1.75});
  look(evidence, crowded, 0, bodyAt(-1.0, 0));
  EXPECT_EQ(stateAt(navigation(evidence), 1.35, 0.55), CellState::kObstacle);
  for (int i = 1; i <= 8; ++i) look(evidence, boxRoom(), i, bodyAt(-1.0 + 0.2 * i, 0));
  for (double y = -1.85; y < 1.9; y += 0.1)
    for (double x = -2.85; x < 2.9; x += 0.1)
      EXPECT_EQ(stateAt(navigation(evidence), x, y), CellState::kFree) << x << ", " << y;
}

TEST(FreeSpaceEvidenceTest, WallsMoveWithTheirKeyframe) {
  FreeSpaceEvidence moved{EvidenceConfig{}}, straight{EvidenceConfig{}};
  const Keyframe keyframe = boxRoom().keyframe(0, bodyAt(0, 0));
  moved.step(keyframe, updateOf({mapKeyframe(0, bodyAt(0, 0))}));
  EXPECT_EQ(stateAt(rooms(moved), 3.05, 0.05), CellState::kObstacle);
  moved.step(std::nullopt, updateOf({mapKeyframe(0, bodyAt(0.3, 0))}));
  EXPECT_EQ(stateAt(rooms(moved), 3.05, 0.05), CellState::kFree) << "none is left behind";
  EXPECT_EQ(stateAt(rooms(moved), 3.35, 0.05), CellState::kObstacle);
  straight.step(keyframe, updateOf({mapKeyframe(0, bodyAt(0.3, 0))}));
  EXPECT_EQ(allVotes(moved), allVotes(straight));
  EXPECT_EQ(count(rooms(moved), CellState::kFree), count(rooms(straight), CellState::kFree));
}

// Mistake 12 of earlier systems: a map in a frame that drifts. A loop moves keyframes by metres and turns
// them.
TEST(FreeSpaceEvidenceTest, AfterALoopNothingIsLeftWhereThePosesWere) {
  FreeSpaceEvidence moved{EvidenceConfig{}}, straight{EvidenceConfig{}};
  const auto mended = [](int i) { return SE3(so3Exp({0, 0, 0.4}), {-5.2, 3.1, 0}) * bodyAt(0.3 * i, 0); };
  MapUpdate loop;
  for (int i = 0; i < 6; ++i) {
    const Keyframe keyframe = boxRoom().keyframe(i, bodyAt(0.3 * i, 0));
    moved.step(keyframe, updateOf({mapKeyframe(i, bodyAt(0.3 * i, 0))}));
    straight.step(keyframe, updateOf({mapKeyframe(i, mended(i))}));
    loop.keyframes.push_back(mapKeyframe(i, mended(i)));
  }
  moved.step(std::nullopt, loop);
  EXPECT_EQ(allVotes(moved), allVotes(straight));
}

TEST(FreeSpaceEvidenceTest, WayAndBackIsAsIfNothingHadMoved) {
  FreeSpaceEvidence evidence{EvidenceConfig{}};
  for (int i = 0; i < 4; ++i) look(evidence, boxRoom(), i, bodyAt(-1.5 + i, 0.3 * i));
  const std::vector<ColumnVotes> votes = allVotes(evidence);
  const StoreyGrid before = rooms(evidence);
  for (const double shift : {0.4, -0.7, 0.0}) {
    std::vector<MapKeyframe> keyframes;
    keyframes.reserve(4);
    for (int i = 0; i < 4; ++i)
      keyframes.push_back(mapKeyframe(i, bodyAt(-1.5 + i + shift, 0.3 * i, 0.1 + shift)));
    evidence.step(std::nullopt, updateOf(keyframes));
  }
  EXPECT_EQ(allVotes(evidence), votes);
  EXPECT_EQ(rooms(evidence).state, before.state);
  EXPECT_EQ(rooms(evidence).clearance_m, before.clearance_m);
}

TEST(FreeSpaceEvidenceTest, SmallMotionCostsNothing) {
  FreeSpaceEvidence evidence{EvidenceConfig{}};
  look(evidence, boxRoom(), 0, bodyAt(0, 0));
  const std::vector<ColumnVotes> votes = allVotes(evidence);
  evidence.step(std::nullopt, updateOf({mapKeyframe(0, bodyAt(0.02, 0.01, 0.101))}));
  EXPECT_EQ(allVotes(evidence), votes);
  evidence.step(std::nullopt, updateOf({mapKeyframe(0, bodyAt(0, 0, 0.12))}));
  EXPECT_NE(allVotes(evidence), votes) << "far points have moved";
}

TEST(FreeSpaceEvidenceTest, StoreysAreApart) {
  FreeSpaceEvidence evidence{EvidenceConfig{}};
  BoxWorld lower = boxRoom(), upper;
  upper.addRoom({-3.03, -2.04}, {1.04, 2.03}, 3.2);
  look(evidence, lower, 0, bodyAt(0, 0), 0);
  look(evidence, upper, 1, bodyAt(-1, 0, 0.1, 3.7), 1);
  EXPECT_EQ(stateAt(rooms(evidence, 0), 2.0, 0.0), CellState::kFree);
  EXPECT_EQ(stateAt(rooms(evidence, 1), 2.0, 0.0), CellState::kUnknown);
  EXPECT_NEAR(rooms(evidence, 1).surface_z_m, 3.2, 0.02);
}

TEST(FreeSpaceEvidenceTest, BetweenStoreysNothingIsSeenUntilArrival) {
  FreeSpaceEvidence evidence{EvidenceConfig{}};
  const BoxWorld world = boxRoom();
  look(evidence, world, 0, bodyAt(0, 0), -1);
  EXPECT_TRUE(evidence.storeys().empty());
  evidence.step(std::nullopt, updateOf({mapKeyframe(0, bodyAt(0, 0), 2)}));
  EXPECT_EQ(stateAt(rooms(evidence, 2), 1.0, 1.0), CellState::kFree);
  evidence.step(std::nullopt, updateOf({mapKeyframe(0, bodyAt(0, 0), 3)}));
  EXPECT_EQ(count(rooms(evidence, 2), CellState::kFree), 0);
  EXPECT_EQ(evidence.storeys().at(FloorId{2}).evidence().numBlocks(), 0u);
  EXPECT_EQ(stateAt(rooms(evidence, 3), 1.0, 1.0), CellState::kFree);
}

TEST(FreeSpaceEvidenceTest, KeyframesBeforeTheFirstFloorWaitForIt) {
  FreeSpaceEvidence evidence{EvidenceConfig{}};
  BoxWorld closet;
  closet.addRoom({-1, -1}, {1, 1});
  look(evidence, closet, 0, bodyAt(0, 0));
  EXPECT_TRUE(evidence.storeys().empty());
  BoxWorld hall;
  hall.addRoom({9, -4}, {19, 4});
  look(evidence, hall, 1, bodyAt(14, 0));
  EXPECT_EQ(stateAt(rooms(evidence), 0.5, 0.5), CellState::kFree);
  EXPECT_EQ(stateAt(rooms(evidence), 14.5, 0.5), CellState::kFree);
}

TEST(FreeSpaceEvidenceTest, MemoryGrowsWithSpaceNotWithTime) {
  FreeSpaceEvidence evidence{EvidenceConfig{}};
  const BoxWorld world = boxRoom();
  size_t bytes = 0;
  for (int i = 0; i < 60; ++i) {
    look(evidence, world, i, bodyAt(0.2 + 0.01 * i, 0.5));
    if (i == 20) bytes = evidence.bytes();
  }
  EXPECT_LT(evidence.bytes(), bytes + bytes / 20);
  EXPECT_EQ(evidence.numKeyframes(), 8u);
  EXPECT_EQ(stateAt(rooms(evidence), 1.0, 1.0), CellState::kFree);
}

TEST(FreeSpaceEvidenceTest, HostileInputIsPassedOver) {
  FreeSpaceEvidence evidence{EvidenceConfig{}};
  look(evidence, boxRoom(), 0, bodyAt(0, 0));
  const std::vector<ColumnVotes> votes = allVotes(evidence);
  Keyframe broken = boxRoom().keyframe(1, bodyAt(0, 0));
  for (KeyframePoint& p : broken.points) p.scan = 7;  // there is one scan
  broken.points[0].scan = 0;
  broken.points[0].position_body.x() = std::nanf("");
  evidence.step(broken, updateOf({mapKeyframe(1, bodyAt(1e7, 0))}));
  SE3 nowhere = bodyAt(0, 0);
  nowhere.translation.x() = std::nan("");
  evidence.step(std::nullopt, updateOf({mapKeyframe(1, nowhere), mapKeyframe(99, bodyAt(0, 0))}));
  EXPECT_EQ(allVotes(evidence), votes);
}

}  // namespace
}  // namespace sgraphs
