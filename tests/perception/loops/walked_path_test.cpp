#include "perception/loops/walked_path.h"

#include <gtest/gtest.h>

namespace sgraphs {
namespace {

// A straight line, a keyframe per metre.
WalkedPath line(int metres, bool registered, double sigma_m, double sigma_rad) {
  WalkedPath path{LoopGateConfig()};
  for (int i = 0; i <= metres; ++i) {
    Keyframe k;
    k.id = KeyframeId{i};
    k.T_odom_body.translation.x() = i;
    if (i > 0) {
      RelativePose r;
      r.from = KeyframeId{i - 1};
      r.to = k.id;
      r.registered = registered;
      r.covariance.setZero();
      r.covariance.diagonal() << Eigen::Vector3d::Constant(sigma_m * sigma_m / 3),
          Eigen::Vector3d::Constant(sigma_rad * sigma_rad / 3);
      k.relative_poses.push_back(r);
    }
    path.add(k);
  }
  return path;
}

// methods.md 7.5: a search radius of 1 m cannot find what 5 m of drift have moved.
TEST(WalkedPathTest, GateOutgrowsFiveMetresOfDriftOfLegs) {
  const WalkedPath path = line(120, false, 0, 0);
  EXPECT_GT(path.gatesFrom(KeyframeId{120}).at(KeyframeId{0}).radius_m, 5.0);
  EXPECT_LT(path.gatesFrom(KeyframeId{120}).at(KeyframeId{110}).radius_m, 1.1);
}

TEST(WalkedPathTest, GateGrowsWithTheOdometrysCovariance) {
  const LoopGate narrow = line(50, true, 0.002, 0).gatesFrom(KeyframeId{50}).at(KeyframeId{0});
  const LoopGate wide = line(50, true, 0.1, 0).gatesFrom(KeyframeId{50}).at(KeyframeId{0});
  const LoopGateConfig c;
  EXPECT_NEAR(wide.radius_m, c.base_m + 50 * c.registered_share + c.sigmas * 0.1 * std::sqrt(50.0), 1e-9);
  EXPECT_LT(narrow.radius_m, wide.radius_m);
}

TEST(WalkedPathTest, HeadingsThatErrMoveWhatIsFar) {
  const LoopGate gate = line(100, true, 0, 0.001).gatesFrom(KeyframeId{100}).at(KeyframeId{0});
  const LoopGateConfig c;
  // Random walk of 0.01 rad over 100 m: 0.58 m at its end.
  EXPECT_NEAR(gate.radius_m, c.base_m + 100 * c.registered_share + c.sigmas * 0.01 * 100 / std::sqrt(3.0),
              1e-9);
  EXPECT_NEAR(gate.yaw_rad, c.base_rad + 100 * c.registered_rad_per_m + c.sigmas * 0.01, 1e-9);
}

TEST(WalkedPathTest, ALoopIsAShortCutUntilItIsWithdrawn) {
  WalkedPath path = line(100, false, 0, 0);
  path.link(KeyframeId{5}, KeyframeId{95});
  EXPECT_NEAR(path.gatesFrom(KeyframeId{100}).at(KeyframeId{0}).walked_m, 10, 1e-9);
  path.unlink(KeyframeId{5}, KeyframeId{95});
  EXPECT_NEAR(path.gatesFrom(KeyframeId{100}).at(KeyframeId{0}).walked_m, 100, 1e-9);
}

TEST(WalkedPathTest, GateNeverGrowsBeyondItsBound) {
  EXPECT_EQ(line(1000, false, 0, 0).gatesFrom(KeyframeId{1000}).at(KeyframeId{0}).radius_m,
            LoopGateConfig().max_m);
}

TEST(WalkedPathTest, LostKeyframesAreStridden) {
  WalkedPath path{LoopGateConfig()};
  for (const int i : {0, 1, 4, 9}) {
    Keyframe k;
    k.id = KeyframeId{i};
    k.T_odom_body.translation.x() = i;
    path.add(k);
  }
  EXPECT_FALSE(path.contains(KeyframeId{2}));
  EXPECT_NEAR(path.along(KeyframeId{9}, KeyframeId{1}).walked_m, 8, 1e-9);
}

}  // namespace
}  // namespace sgraphs
