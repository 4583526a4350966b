#include "perception/relocalise/candidates.h"

#include <gtest/gtest.h>

namespace sgraphs {
namespace {

SE3 at(double x_m) {
  return {Eigen::Quaterniond::Identity(), {x_m, 0, 0}};
}

// What a look says of a pose x_m off the truth along one axis.
Look lookAt(double x_m, double walked_m, double conflict_share = 0.0, double overlap = 0.8) {
  Look look;
  look.at_m = walked_m;
  look.T_map_odom = at(x_m);
  look.check.overlap = overlap;
  look.check.inlier_share = 0.98;
  look.check.conflict_share = conflict_share;
  look.check.fit_share = 0.9;
  look.check.seen = 500;
  look.check.sigma_m = 0.01;
  look.check.sigma_rad = 0.002;
  return look;
}

class CandidatesTest : public ::testing::Test {
 protected:
  // A look from a pose in odom; whether the robot is found with it.
  bool look(double walked_m, const std::vector<Look>& looks, bool complete = true) {
    dut_.add(looks, SE3(), walked_m, complete);
    return dut_.found() != nullptr;
  }
  RelocaliseConfig config_;
  LoopVerificationConfig verification_;
  Candidates dut_{config_, verification_};
};

TEST_F(CandidatesTest, SeveralLooksSomeMetresApartProveAPose) {
  EXPECT_FALSE(look(1, {lookAt(0, 1)}));
  EXPECT_FALSE(look(2, {lookAt(0.05, 2)}));
  EXPECT_FALSE(look(3, {lookAt(0.1, 3)})) << "the looks lie too close together";
  EXPECT_TRUE(look(4, {lookAt(0.1, 4)}));
}

TEST_F(CandidatesTest, LooksThatDisagreeProveNothing) {
  for (int i = 0; i < 20; ++i) EXPECT_FALSE(look(i, {lookAt(1.5 * i, i)}));
}

TEST_F(CandidatesTest, WhatLooksAlikeFromEverywhereStaysOpen) {
  for (int i = 0; i < 40; ++i) EXPECT_FALSE(look(i, {lookAt(0, i), lookAt(4, i)}));
  EXPECT_EQ(dut_.all().size(), 2u);
}

TEST_F(CandidatesTest, OneLookThatSeesThroughAWallRefutes) {
  for (int i = 0; i < 6; ++i) look(i, {lookAt(0, i), lookAt(4, i)});
  EXPECT_TRUE(look(6, {lookAt(0, 6), lookAt(4, 6, 0.08)}));
  EXPECT_EQ(dut_.all().size(), 1u);
}

// An end wall is a few patches of many: each look is little worse at the office next door.
TEST_F(CandidatesTest, ManyLooksThatAreALittleWorseRefuteTogether) {
  for (int i = 0; i < 6; ++i) look(i, {lookAt(0, i), lookAt(4, i)});
  const auto little_worse = [](int i) {
    Look l = lookAt(4, i);
    l.check.inlier_share -= 0.09;
    return l;
  };
  EXPECT_FALSE(look(6, {lookAt(0, 6), little_worse(6)}));
  bool found = false;
  for (int i = 7; i < 14 && !found; ++i) found = look(i, {lookAt(0, i), little_worse(i)});
  EXPECT_TRUE(found);
}

TEST_F(CandidatesTest, NoiseRefutesNobody) {
  const auto noisy = [](double x_m, int i, double by) {
    Look l = lookAt(x_m, i);
    l.check.inlier_share -= by;
    return l;
  };
  for (int i = 0; i < 60; ++i)
    EXPECT_FALSE(look(i, {noisy(0, i, i % 2 ? 0.03 : 0), noisy(4, i, i % 2 ? 0 : 0.03)}));
  EXPECT_EQ(dut_.all().size(), 2u);
}

// Where the first walk did not go, nothing can speak against a place.
TEST_F(CandidatesTest, ARivalOutOfTheMapsSightIsNotRefuted) {
  for (int i = 0; i < 10; ++i) look(i, {lookAt(0, i), lookAt(4, i)});
  for (int i = 10; i < 18; ++i) EXPECT_FALSE(look(i, {lookAt(0, i)})) << i;
}

TEST_F(CandidatesTest, NothingIsSettledWhileMatchesWereLeftOut) {
  for (int i = 0; i < 10; ++i) EXPECT_FALSE(look(i, {lookAt(0, i)}, false));
  EXPECT_TRUE(look(10, {lookAt(0, 10)}));
}

TEST_F(CandidatesTest, TheyAreBounded) {
  for (int i = 0; i < 20; ++i) {
    std::vector<Look> many;
    many.reserve(24);
    for (int k = 0; k < 24; ++k) many.push_back(lookAt(3.0 * k + 100.0 * i, i));
    look(i, many);
    EXPECT_LE(dut_.all().size(), 32u);
  }
}

}  // namespace
}  // namespace sgraphs
