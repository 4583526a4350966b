#include "tools/eval/loop_error.h"

#include <gtest/gtest.h>

namespace sgraphs {
namespace {

// Along x for 30 m, 10 m aside, and back beside the first way: x = 0 is passed at 0 and at 70 s, at 1 m/s.
std::vector<StampedPose> hairpin(double beside_m) {
  std::vector<StampedPose> truth;
  for (int i = 0; i <= 700; ++i) {
    const double s = 0.1 * i;
    StampedPose p;
    p.time = Time{i * 100'000};
    p.pose.translation = s < 30   ? Eigen::Vector3d(s, 0, 0)
                         : s < 35 ? Eigen::Vector3d(30, s - 30, 0)
                         : s < 40 ? Eigen::Vector3d(30, 5 - (s - 35) * (5 - beside_m) / 5, 0)
                                  : Eigen::Vector3d(30 - (s - 40), beside_m, 0);
    truth.push_back(p);
  }
  return truth;
}

MeasuredLink loop(const std::vector<StampedPose>& truth, size_t from, size_t to, double off_m) {
  MeasuredLink link{"loop", truth[from].time, truth[to].time, truth[from].pose.inverse() * truth[to].pose,
                    Matrix6d::Identity()};
  link.T_from_to.translation.y() += off_m;
  return link;
}

TEST(LoopErrorTest, TrueAndFalseLoopsAreCounted) {
  const auto truth = hairpin(0.2);
  const LoopResult r =
      judgeLoops({loop(truth, 100, 600, 0.02), loop(truth, 50, 650, 0.04), loop(truth, 80, 620, 0.5)}, truth);
  EXPECT_EQ(r.accepted, 3u);
  EXPECT_EQ(r.wrong, 1u);
  EXPECT_NEAR(r.max_m, 0.04, 1e-9);
  EXPECT_EQ(r.revisits, 1u);
  EXPECT_EQ(r.missed, 0u);
}

TEST(LoopErrorTest, AReturnWithoutLoopIsMissed) {
  EXPECT_EQ(judgeLoops({}, hairpin(0.2)).missed, 1u);
}

TEST(LoopErrorTest, PassingFartherAwayIsNoReturn) {
  EXPECT_EQ(judgeLoops({}, hairpin(2.0)).revisits, 0u);
}

TEST(LoopErrorTest, AFalseLoopDoesNotCreditAReturn) {
  const auto truth = hairpin(0.2);
  EXPECT_EQ(judgeLoops({loop(truth, 100, 600, 1.0)}, truth).missed, 1u);
}

TEST(LoopErrorTest, LinksOfOtherKindsAreNoLoops) {
  const auto truth = hairpin(0.2);
  MeasuredLink link = loop(truth, 100, 600, 0);
  link.kind = "neighbour";
  EXPECT_EQ(judgeLoops({link}, truth).accepted, 0u);
}

}  // namespace
}  // namespace sgraphs
