#include "perception/loops/loop_verification.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/perception/loops/loop_world.h"

namespace sgraphs {
namespace {

using test::bodyAt;

// A room that is like itself in no other pose.
simulate::Scene furnished() {
  simulate::Scene scene = simulate::makeBoxRoom(9, 6);
  scene.boxes.push_back({"cupboard", {0.3, 4.2}, {0.6, 1.6}, 0, 1.9, 0});
  scene.boxes.push_back({"locker", {6.2, 0.3}, {1.2, 0.6}, 0, 2.1, 0});
  return scene;
}

Place placeAt(const simulate::SimulatedWorld& world, const SE3& T, int64_t id, uint64_t seed) {
  return Place(test::keyframeAt(world, T, id, seed));
}

LoopCheck check(const Place& newer, const Place& older, const SE3& guess) {
  const OldSurroundings old({{&older, SE3()}});
  return checkLoop({{&newer, SE3()}}, old, guess, LoopVerificationConfig());
}

class LoopVerificationTest : public testing::Test {
 protected:
  const simulate::SimulatedWorld world_{furnished()};
  const SE3 T_old_ = bodyAt(3.0, 2.5, 0.1);
  const SE3 T_new_ = bodyAt(4.2, 3.1, 2.0);
  const Place old_ = placeAt(world_, T_old_, 0, 1);
  const Place new_ = placeAt(world_, T_new_, 90, 2);
  const SE3 T_old_new_ = T_old_.inverse() * T_new_;
};

TEST_F(LoopVerificationTest, TrueReturnIsMeasuredToAFewMillimetres) {
  const SE3 guess = T_old_new_ * SE3(so3Exp({0, 0, 0.05}), {0.25, -0.2, 0.05});
  const LoopCheck c = check(new_, old_, guess);
  const SE3 error = T_old_new_.inverse() * c.T_anchor_body;
  EXPECT_LT(error.translation.norm(), 0.01);
  EXPECT_LT(so3Log(error.rotation).norm(), 0.004);
  EXPECT_TRUE(c.alike(LoopVerificationConfig()));
  EXPECT_TRUE(c.fixed(LoopVerificationConfig()));
  EXPECT_GT(c.inlier_share, 0.95);
  EXPECT_LT(c.conflict_share, 0.01);
}

// predecessors.md 3.2 item 9: the registration was seeded with the inverse of the transform it needed.
TEST_F(LoopVerificationTest, GuessLeadsFromTheNewBodyToTheOld) {
  const LoopCheck inverse = check(new_, old_, T_old_new_.inverse());
  EXPECT_FALSE(inverse.alike(LoopVerificationConfig()));
  const LoopCheck back = check(old_, new_, T_old_new_.inverse());
  EXPECT_LT((back.T_anchor_body * T_old_new_).translation.norm(), 0.01);
  EXPECT_TRUE(back.alike(LoopVerificationConfig()));
}

// A wall across the room that was not there: the rest fits as well as before.
TEST_F(LoopVerificationTest, AWallWhereTheOtherSawThroughRefutes) {
  simulate::Scene divided = furnished();
  divided.walls.push_back({{6.5, 0}, {6.5, 6}, 0.1, 0, 2.8});
  const simulate::SimulatedWorld other(divided);
  const Place newer = placeAt(other, T_new_, 90, 2);
  const LoopCheck c = check(newer, old_, T_old_new_);
  EXPECT_LT((T_old_new_.inverse() * c.T_anchor_body).translation.norm(), 0.02);  // it does fit
  EXPECT_GT(c.conflict_share, 0.05);
  EXPECT_FALSE(c.alike(LoopVerificationConfig()));
  EXPECT_TRUE(c.refuted(LoopVerificationConfig()));
}

// methods.md 7.5: fitness without a test of overlap. Two ends of a building share one wall.
TEST(LoopVerificationOverlapTest, FitWithoutOverlapProvesNothing) {
  simulate::Scene scene = simulate::makeBoxRoom(16, 5);
  scene.walls.push_back({{8, 0}, {8, 2.2}, 0.1, 0, 2.8});
  scene.walls.push_back({{8, 2.8}, {8, 5}, 0.1, 0, 2.8});
  const simulate::SimulatedWorld world(scene);
  const SE3 T_old = bodyAt(3, 1, 0), T_new = bodyAt(13, 1, 0);
  const Place older = placeAt(world, T_old, 0, 1), newer = placeAt(world, T_new, 90, 2);
  const LoopCheck c = check(newer, older, T_old.inverse() * T_new);
  EXPECT_LT(c.overlap, LoopVerificationConfig().min_overlap);
  EXPECT_FALSE(c.alike(LoopVerificationConfig()));
}

// Nothing in the middle of a bare corridor says how far along it is.
TEST(LoopVerificationCorridorTest, BareCorridorDoesNotFixThePlaceAlongIt) {
  const simulate::SimulatedWorld world(simulate::makeCorridor(120, 2.2));
  const SE3 T_old = bodyAt(60, 1.1, 0), T_new = bodyAt(61, 1.2, 3.1);
  const Place older = placeAt(world, T_old, 0, 1), newer = placeAt(world, T_new, 90, 2);
  const LoopCheck c = check(newer, older, T_old.inverse() * T_new);
  EXPECT_TRUE(c.alike(LoopVerificationConfig()));
  EXPECT_FALSE(c.fixed(LoopVerificationConfig()));
  EXPECT_GT(c.sigma_m, 0.3);
}

TEST(PlaceTest, StaysWithinFortyKilobytes) {
  const simulate::SimulatedWorld world(furnished());
  EXPECT_LT(placeAt(world, bodyAt(3, 2.5, 0), 0, 1).bytes(), 40'000U);
}

TEST(PlacePatchesTest, LieOnTheWallsAndFaceTheRoom) {
  const simulate::SimulatedWorld world(simulate::makeBoxRoom(9, 6));
  const SE3 T = bodyAt(3, 2.5, 0.7);
  const std::vector<Surfel> patches = patchesOf(test::keyframeAt(world, T, 0, 1), 380, 120);
  ASSERT_GT(patches.size(), 150U);
  std::vector<double> offs;
  for (const Surfel& s : patches) {
    const Eigen::Vector3d p = T * s.mean, n = T.rotation * s.normal;
    const double off = std::min({std::abs(p.x()), std::abs(p.x() - 9), std::abs(p.y()), std::abs(p.y() - 6),
                                 std::abs(p.z()), std::abs(p.z() - 2.8)});
    EXPECT_LT(off, 0.10);  // in a corner two walls may share a cube
    EXPECT_GT(n.dot(Eigen::Vector3d(4.5, 3, 1.4) - p), 0);
    offs.push_back(off);
  }
  std::sort(offs.begin(), offs.end());
  EXPECT_LT(offs[offs.size() / 2], 0.006);
  EXPECT_LE(patchesOf(test::keyframeAt(world, T, 0, 1), 30, 10).size(), 40U);
}

TEST(PlacePatchesTest, PackingKeepsWhatARegistrationAsks) {
  Surfel s;
  s.mean = {1.234, -5.5, 0.7};
  s.normal = Eigen::Vector3d(0.6, 0.8, 0);
  s.covariance << 4e-3, 1e-3, 2e-4, 1e-3, 5e-3, 3e-4, 2e-4, 3e-4, 6e-3;
  s.count = 31;
  s.variance_m2 = 2e-5;
  const Surfel t = PackedPatch(s).unpack();
  EXPECT_LT((t.mean - s.mean).norm(), 1e-6);
  EXPECT_LT((t.normal - s.normal).norm(), 1e-6);
  EXPECT_LT((t.covariance - s.covariance).norm(), 1e-8);
  EXPECT_NEAR(t.count, 31, 1e-6);
  EXPECT_NEAR(t.variance_m2, 2e-5, 1e-10);
}

}  // namespace
}  // namespace sgraphs
