#include "perception/loops/loop_finder.h"

#include <gtest/gtest.h>

#include <numbers>

#include "tests/perception/loops/loop_world.h"

namespace sgraphs {
namespace {

using test::findLoops;
using test::LoopOutcome;
using test::LoopWalk;
using test::MapDrift;

// A ring corridor 2.4 m wide about a core, 44 x 30 m outside, with cupboards and recesses here and there;
// once around and 14 m on.
simulate::Scene ring() {
  simulate::Scene scene = simulate::makeBoxRoom(44, 30);
  scene.boxes.push_back({"core", {22, 15}, {39.2, 25.2}, 0, 2.8, 0});
  const double along[] = {4, 9.5, 17, 21, 29.5, 36, 40};
  for (const double x : along) {
    scene.boxes.push_back({"cupboard", {x, 0.2}, {0.7 + 0.03 * x, 0.4}, 0, 2, 0});
    scene.boxes.push_back({"shelf", {44 - 0.93 * x, 29.8}, {1.1 - 0.01 * x, 0.4}, 0, 1.8, 0});
  }
  for (const double y : {5.0, 11.0, 13.5, 22.0}) {
    scene.boxes.push_back({"locker", {0.2, y}, {0.4, 0.6 + 0.04 * y}, 0, 1.9, 0});
    scene.boxes.push_back({"rack", {43.8, 28 - 0.9 * y}, {0.4, 1.5 - 0.04 * y}, 0, 2.2, 0});
  }
  scene.path.waypoints = {{{6, 1.3}, 0},    {{42.7, 1.3}, 0}, {{42.7, 28.7}, 0},
                          {{1.3, 28.7}, 0}, {{1.3, 1.3}, 0},  {{20, 1.3}, 0}};
  return scene;
}

// methods.md 7.5 and 3.1 of predecessors.md: the search radius was 1 m, the drift more.
TEST(LoopFinderTest, FiveMetresOfDriftAreClosed) {
  const LoopWalk walk = test::walkThrough(ring(), 3);
  const LoopOutcome found = findLoops(walk, {0.0018, 0.0, false});
  EXPECT_GT(found.largest_drift_m, 5.0);
  EXPECT_GE(found.accepted.size(), 2U);
  EXPECT_EQ(found.false_loops, 0);
  EXPECT_LT(found.worst_m, 0.10);
  for (const LoopClosure& loop : found.accepted) EXPECT_LT(loop.pose.from, KeyframeId{40});
}

void expectSame(const LoopOutcome& a, const LoopOutcome& b) {
  ASSERT_EQ(a.accepted.size(), b.accepted.size());
  for (size_t i = 0; i < a.accepted.size(); ++i) {
    EXPECT_EQ(a.accepted[i].id, b.accepted[i].id);
    EXPECT_EQ(a.accepted[i].pose.T_from_to.translation, b.accepted[i].pose.T_from_to.translation);
    EXPECT_EQ(a.accepted[i].pose.covariance, b.accepted[i].pose.covariance);
  }
}

TEST(LoopFinderTest, SmallDriftIsClosedWithCalibratedCovariancesAndAlwaysAlike) {
  const LoopWalk walk = test::walkThrough(ring(), 4);
  const LoopOutcome found = findLoops(walk, {0.0002, 0.0, true});
  expectSame(found, findLoops(walk, {0.0002, 0.0, true}));
  ASSERT_GE(found.accepted.size(), 2U);
  EXPECT_EQ(found.false_loops, 0);
  EXPECT_LT(found.worst_m, 0.03);
  for (const LoopClosure& loop : found.accepted) {
    const SE3 T_true = walk.T_building_body[static_cast<size_t>(loop.pose.from.value)].inverse() *
                       walk.T_building_body[static_cast<size_t>(loop.pose.to.value)];
    const Vector6d e = se3Log(T_true.inverse() * loop.pose.T_from_to);
    const Matrix6d& C = loop.pose.covariance;
    EXPECT_LT(e.head<3>().dot(C.topLeftCorner<3, 3>().inverse() * e.head<3>()), 16.3);  // 99.9 % of chi2(3)
    EXPECT_LT(e.tail<3>().dot(C.bottomRightCorner<3, 3>().inverse() * e.tail<3>()), 16.3);
    EXPECT_TRUE(loop.pose.kind == RelativePoseKind::kLoop && loop.pose.from < loop.pose.to);
    EXPECT_TRUE(loop.overlap > 0.3 && loop.overlap <= 1 && loop.inlier_share > 0.85 &&
                loop.inlier_share <= 1);
  }
}

// The same storey again, one above: every wall is in its place.
TEST(LoopFinderTest, StoreysThatAreAlikeAreNotJoined) {
  simulate::Scene scene = simulate::makeBoxRoom(14, 9);
  scene.boxes.push_back({"cupboard", {0.3, 4.2}, {0.6, 1.6}, 0, 1.9, 0});
  scene.boxes.push_back({"locker", {6.2, 0.3}, {1.2, 0.6}, 0, 2.1, 0});
  scene.path.waypoints = {{{2, 2}, 0}, {{12, 2}, 0}, {{12, 7}, 0}, {{2, 7}, 0}, {{2, 3}, 0}};
  for (const double rise_m : {3.2, 0.0}) {  // stairs, and a lift, whose motion nothing measures
    LoopWalk walk = test::walkThrough(scene, 5);
    const size_t n = walk.keyframes.size();
    std::vector<FloorId> floors(n, FloorId{0});
    for (size_t i = 0; i < n; ++i) {
      Keyframe k = walk.keyframes[i];
      k.id.value += static_cast<int64_t>(n);
      walk.keyframes.push_back(k);
      SE3 T = walk.T_building_body[i];
      T.translation.z() += rise_m;
      walk.T_building_body.push_back(T);
      floors.push_back(FloorId{1});
    }
    const LoopOutcome found = findLoops(walk, {}, {}, floors);
    EXPECT_EQ(found.false_loops, 0) << rise_m;
    EXPECT_TRUE(found.withdrawn.empty()) << rise_m;
    EXPECT_FALSE(found.searching);
    // What a lift's ride led to before the new storey was known is taken back.
    if (rise_m == 0) {
      const LoopOutcome late = findLoops(walk, {}, {}, floors, 15);
      EXPECT_FALSE(late.withdrawn.empty());
      EXPECT_EQ(late.false_loops, 0);
    }
  }
}

// A hall that looks the same after half a turn.
TEST(LoopFinderTest, HalfTurnOfASymmetricHallIsNoReturn) {
  simulate::Scene scene = simulate::makeBoxRoom(24, 14, 4);
  scene.boxes.push_back({"rack", {5, 3}, {3, 0.8}, 0, 2.2, 0});
  scene.boxes.push_back({"rack", {19, 11}, {3, 0.8}, 0, 2.2, 0});
  scene.path.waypoints = {{{3, 5}, 0}, {{8, 7}, 0}, {{16, 7}, 0}, {{21, 9}, 0}, {{21, 4}, 0}, {{12, 3}, 0}};
  const LoopWalk walk = test::walkThrough(scene, 6);
  for (int seed = 0; seed < 10; ++seed)
    EXPECT_EQ(findLoops(walk, {0.0004 * (seed - 5), 0, seed % 2 == 0}).false_loops, 0) << seed;
}

// A corridor with an office every 4 m, one like the other; ten ways in which the map may err.
TEST(LoopFinderTest, TwentyIdenticalOfficesGiveNoFalseLoop) {
  const LoopWalk walk = test::walkThrough(test::shippedScene("offices20"), 7, 90);
  for (int seed = 0; seed < 10; ++seed) {
    const MapDrift drift{0.0006 * (seed - 5), 0.006 * (seed % 3 - 1), seed % 2 == 0};
    EXPECT_EQ(findLoops(walk, drift).false_loops, 0) << seed;
  }
}

// An office entered for the first time looks like the one next door, and the gate reaches that far.
TEST(LoopFinderTest, AnOfficeNeverSeenIsNotTheOneNextDoor) {
  LoopsConfig config;
  config.gate.legs_share = 0.15;
  const LoopWalk walk = test::walkThrough(test::shippedScene("offices20"), 8, 60);
  for (const double yaw : {0.001, -0.001})
    EXPECT_EQ(findLoops(walk, {yaw, 0, false}, config).false_loops, 0) << yaw;
}

TEST(LoopFinderTest, SaysNothingWhereItIsSwitchedOff) {
  LoopsConfig off;
  off.enabled = false;
  LoopFinder dut(off);
  MapUpdate update;
  update.round = 7;
  const LoopClosures loops = dut.step(std::nullopt, update);
  EXPECT_EQ(loops.round, 7);
  EXPECT_TRUE(loops.accepted.empty() && loops.withdrawn.empty() && !loops.searching);
}

TEST(LoopFinderTest, RoundsWithoutCloudAndKeyframesWithoutPoseAreBorne) {
  LoopFinder dut{LoopsConfig()};
  Keyframe bare;
  bare.id = KeyframeId{3};
  MapUpdate update;
  update.newest = bare.id;
  for (int64_t round = 0; round < 3; ++round) {
    update.round = round;
    EXPECT_EQ(dut.step(round == 1 ? std::optional<Keyframe>(bare) : std::nullopt, update).round, round);
  }
}

}  // namespace
}  // namespace sgraphs
