#include "perception/loops/loop_consistency.h"

#include <gtest/gtest.h>

#include <bit>

#include "perception/loops/loop_acceptance.h"

namespace sgraphs {
namespace {

// Out along x for `half` metres and back beside it: keyframe i was passed again by 2 * half - i.
WalkedPath thereAndBack(int half, const LoopsConfig& config = {}) {
  WalkedPath path(config.gate);
  for (int i = 0; i <= 2 * half; ++i) {
    Keyframe k;
    k.id = KeyframeId{i};
    const bool back = i > half;
    k.T_odom_body = SE3(so3Exp({0, 0, back ? 3.14159265 : 0.0}), {back ? 2.0 * half - i : i, 0, 0});
    if (i > 0) {
      RelativePose r;
      r.from = KeyframeId{i - 1};
      r.to = k.id;
      r.registered = true;
      r.covariance = 1e-6 * Matrix6d::Identity();
      k.relative_poses.push_back(r);
    }
    path.add(k);
  }
  return path;
}

MeasuredLoop loopBetween(const WalkedPath& path, int from, int to, double off_m = 0) {
  MeasuredLoop loop{KeyframeId{from}, KeyframeId{to}, SE3(), 1e-4 * Matrix6d::Identity()};
  loop.T_from_to = path.odometryOf(loop.from).inverse() * path.odometryOf(loop.to);
  loop.T_from_to.translation.x() += off_m;
  return loop;
}

TEST(LoopConsistencyTest, TrueLoopsAgreeAndAShiftedOneDoesNot) {
  const WalkedPath path = thereAndBack(20);
  EXPECT_TRUE(consistent(loopBetween(path, 4, 36), loopBetween(path, 9, 31), path));
  EXPECT_FALSE(consistent(loopBetween(path, 4, 36), loopBetween(path, 9, 31, 4.0), path));
}

TEST(LoopConsistencyTest, LoopsOfTheSameErrorAgreeWhateverTheOdometrySays) {
  // Drift of 4 m between the two passages: the odometry within each is right.
  const WalkedPath path = thereAndBack(20);
  EXPECT_TRUE(consistent(loopBetween(path, 4, 36, 4.0), loopBetween(path, 9, 31, 4.0), path));
}

TEST(LoopConsistencyTest, LargestCliqueIsExact) {
  // 0-1-2-3 joined to each other, 4 and 5 to 3 only, 6 to nobody.
  std::vector<uint64_t> graph(7, 0);
  const auto join = [&](int a, int b) {
    graph[static_cast<size_t>(a)] |= uint64_t{1} << b;
    graph[static_cast<size_t>(b)] |= uint64_t{1} << a;
  };
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < i; ++j) join(i, j);
  join(3, 4);
  join(4, 5);
  EXPECT_EQ(largestClique(graph), uint64_t{0b1111});
  EXPECT_EQ(largestClique({}), uint64_t{0});
  EXPECT_EQ(largestClique({0, 0}), uint64_t{1});
}

TEST(LoopConsistencyTest, CliqueAgreesWithExhaustiveSearch) {
  uint64_t state = 12345;
  for (int trial = 0; trial < 40; ++trial) {
    const int n = 10;
    std::vector<uint64_t> graph(n, 0);
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < i; ++j) {
        state = state * 6364136223846793005ULL + 1442695040888963407ULL;
        if ((state >> 40) % 2 == 0) continue;
        graph[static_cast<size_t>(i)] |= uint64_t{1} << j;
        graph[static_cast<size_t>(j)] |= uint64_t{1} << i;
      }
    int best = 0;
    for (uint64_t set = 0; set < (1U << n); ++set) {
      bool clique = true;
      for (int i = 0; i < n && clique; ++i)
        if ((set >> i) & 1) clique = (set & ~graph[static_cast<size_t>(i)]) == (uint64_t{1} << i);
      if (clique) best = std::max(best, std::popcount(set));
    }
    EXPECT_EQ(std::popcount(largestClique(graph)), best) << trial;
  }
}

// A search that found one place, beyond doubt.
LoopVerdict verdictOf(const MeasuredLoop& loop, double correction_m, bool map_refuted) {
  LoopVerdict verdict;
  verdict.keyframe = loop.to;
  verdict.map_refuted = map_refuted;
  LoopHypothesis h;
  h.loop = loop;
  h.correction_m = correction_m;
  h.gate_m = 6;
  h.check.overlap = 0.6;
  h.check.inlier_share = 0.96;
  h.check.fit_share = 0.8;
  verdict.hypotheses.push_back(h);
  return verdict;
}

TEST(LoopAcceptanceTest, SmallCorrectionsAreTakenAtOnce) {
  const WalkedPath path = thereAndBack(20);
  LoopAcceptance dut{LoopsConfig()};
  EXPECT_EQ(dut.step(verdictOf(loopBetween(path, 9, 31), 0.1, false), path).accepted.size(), 1U);
}

TEST(LoopAcceptanceTest, ALoneLargeCorrectionWaitsForASecondFromElsewhere) {
  const WalkedPath path = thereAndBack(20);
  LoopAcceptance dut{LoopsConfig()};
  EXPECT_TRUE(dut.step(verdictOf(loopBetween(path, 9, 31, 4), 4, true), path).accepted.empty());
  EXPECT_EQ(dut.step(verdictOf(loopBetween(path, 7, 33, 4), 4, true), path).accepted.size(), 2U);
}

TEST(LoopAcceptanceTest, LargeCorrectionsOfAMapThatNothingRefutesAreNeverTaken) {
  const WalkedPath path = thereAndBack(20);
  LoopAcceptance dut{LoopsConfig()};
  for (const int i : {9, 7, 5, 3})
    EXPECT_TRUE(dut.step(verdictOf(loopBetween(path, i, 40 - i, 4), 4, false), path).accepted.empty());
}

TEST(LoopAcceptanceTest, TwoPlacesThatAreAlikeAreNone) {
  const WalkedPath path = thereAndBack(20);
  LoopAcceptance dut{LoopsConfig()};
  LoopVerdict verdict = verdictOf(loopBetween(path, 9, 31), 0.1, false);
  verdict.hypotheses.push_back(verdict.hypotheses.front());
  verdict.hypotheses.back().loop = loopBetween(path, 9, 31, 4);
  verdict.hypotheses.back().check.inlier_share -= 0.03;
  EXPECT_TRUE(dut.step(verdict, path).accepted.empty());
  // And what it could have been speaks against the next, too.
  EXPECT_TRUE(dut.step(verdictOf(loopBetween(path, 5, 35, 4), 0.1, true), path).accepted.empty());
}

TEST(LoopAcceptanceTest, WhatALargerSetContradictsIsWithdrawn) {
  LoopsConfig config;
  config.rival_memory_m = 0;
  const WalkedPath path = thereAndBack(20, config);
  LoopAcceptance dut(config);
  ASSERT_EQ(dut.step(verdictOf(loopBetween(path, 12, 28, 4), 0.1, false), path).accepted.size(), 1U);
  EXPECT_TRUE(dut.step(verdictOf(loopBetween(path, 9, 31), 0.1, false), path).withdrawn.empty());
  const LoopAcceptance::Change change = dut.step(verdictOf(loopBetween(path, 7, 33), 0.1, false), path);
  ASSERT_EQ(change.withdrawn.size(), 1U);
  EXPECT_EQ(change.withdrawn.front().from, KeyframeId{12});
  EXPECT_EQ(change.accepted.size(), 2U);
}

}  // namespace
}  // namespace sgraphs
