#include "drivers/spot/frame_tree.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace sgraphs {
namespace {

const SE3 kTOdomBody(so3Exp({0.1, -0.2, 1.3}), {3, -4, 0.5});
const SE3 kTOther(so3Exp({-0.7, 0.4, 2.0}), {-1, 2, 7});

void expectNear(const std::optional<SE3>& T, const SE3& expected) {
  ASSERT_TRUE(T.has_value());
  EXPECT_LT(se3Log(expected.inverse() * *T).norm(), 1e-12);
}

FrameTree bodyRoot() {
  return {{"body", {"", {}}}, {"odom", {"body", kTOdomBody.inverse()}}, {"vision", {"body", kTOther}}};
}

TEST(FrameTreeTest, EdgesMayPointEitherWay) {
  expectNear(findTransform(bodyRoot(), "odom", "body").T_dst_src, kTOdomBody);
  expectNear(findTransform(bodyRoot(), "body", "odom").T_dst_src, kTOdomBody.inverse());
  const FrameTree odom_root{{"odom", {"", {}}}, {"body", {"odom", kTOdomBody}}};
  expectNear(findTransform(odom_root, "odom", "body").T_dst_src, kTOdomBody);
}

TEST(FrameTreeTest, TheRootMayBeAnywhere) {
  // odom and body on two branches below a frame that is no child of its own and no root by name.
  const FrameTree tree{{"a", {"ground", kTOther}},
                       {"odom", {"a", kTOther.inverse()}},
                       {"b", {"ground", kTOdomBody * kTOther}},
                       {"body", {"b", kTOther.inverse()}}};
  expectNear(findTransform(tree, "odom", "body").T_dst_src, kTOdomBody);
  expectNear(findTransform(tree, "ground", "odom").T_dst_src, {});
}

TEST(FrameTreeTest, AFrameInItselfIsIdentity) {
  expectNear(findTransform(bodyRoot(), "odom", "odom").T_dst_src, {});
  expectNear(findTransform({{"body", {"", {}}}}, "body", "body").T_dst_src, {});
}

TEST(FrameTreeTest, WhatHangsAboveTheMeetingPointDoesNotMatter) {
  FrameTree tree = bodyRoot();
  tree["body"] = {"broken", {Eigen::Quaterniond(0, 0, 0, 0), {NAN, 0, 0}}};
  expectNear(findTransform(tree, "odom", "body").T_dst_src, kTOdomBody);
}

TEST(FrameTreeTest, ErrorsNameTheFrame) {
  FrameTree tree = bodyRoot();
  EXPECT_EQ(findTransform({}, "odom", "body").error, "no frame 'odom'");
  EXPECT_EQ(findTransform(tree, "gpe", "body").error, "no frame 'gpe'");
  EXPECT_EQ(findTransform(tree, "odom", "hand").error, "no frame 'hand'");
  tree["odom"].parent = "";
  EXPECT_EQ(findTransform(tree, "odom", "body").error, "frames 'odom' and 'body' are not connected");
  tree["odom"].parent = "nowhere";
  EXPECT_EQ(findTransform(tree, "odom", "body").error, "frames 'odom' and 'body' are not connected");
}

TEST(FrameTreeTest, ParentsInACircleEnd) {
  FrameTree tree = bodyRoot();
  tree["body"].parent = "odom";
  EXPECT_NE(findTransform(tree, "odom", "body").error.find("in a circle"), std::string::npos);
  tree["body"].parent = "body";
  EXPECT_EQ(findTransform(tree, "odom", "body").error, "the parents of frame 'body' go in a circle");
  EXPECT_EQ(findTransform(tree, "body", "body").error, "the parents of frame 'body' go in a circle");
}

TEST(FrameTreeTest, PosesThatCannotBeRightAreRefusedByName) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const SE3& bad : {SE3(Eigen::Quaterniond::Identity(), {0, nan, 0}), SE3({0, 0, 0, 0}, {0, 0, 0}),
                         SE3({nan, 0, 0, 0}, {0, 0, 0}), SE3({2, 0, 0, 0}, {0, 0, 0}),
                         SE3(Eigen::Quaterniond::Identity(), {0, 0, INFINITY})}) {
    FrameTree tree = bodyRoot();
    tree["odom"].T_parent_child = bad;
    const FrameLookup lookup = findTransform(tree, "odom", "body");
    EXPECT_FALSE(lookup.T_dst_src);
    EXPECT_NE(lookup.error.find("'odom'"), std::string::npos) << lookup.error;
    EXPECT_TRUE(findTransform(tree, "vision", "body").T_dst_src);
  }
}

TEST(FrameTreeTest, ARoundedQuaternionIsNormalised) {
  FrameTree tree = bodyRoot();
  tree["odom"].T_parent_child.rotation.coeffs() *= 1.001;
  const auto T = findTransform(tree, "odom", "body").T_dst_src;
  ASSERT_TRUE(T);
  EXPECT_NEAR(T->rotation.norm(), 1, 1e-12);
  expectNear(T, kTOdomBody);
}

}  // namespace
}  // namespace sgraphs
