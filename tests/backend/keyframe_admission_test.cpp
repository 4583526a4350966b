#include "backend/keyframe_admission.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>

namespace sgraphs {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

SituationalGraph graphWithKeyframes(std::initializer_list<int64_t> ids) {
  SituationalGraph graph;
  for (const int64_t id : ids) {
    KeyframeNode node;
    node.id = KeyframeId{id};
    node.time = Time{1000 * id + 1};
    node.T_odom_body.translation.x() = static_cast<double>(id);
    graph.keyframes.emplace(node.id, node);
  }
  return graph;
}

Keyframe keyframeFive() {
  Keyframe keyframe;
  keyframe.id = KeyframeId{5};
  keyframe.time = Time{5001};
  keyframe.T_odom_body.translation.x() = 5;
  RelativePose z;
  z.from = KeyframeId{4};
  z.to = KeyframeId{5};
  z.T_from_to.translation.x() = 1;
  keyframe.relative_poses.push_back(z);
  return keyframe;
}

TEST(AdmissionTest, SoundKeyframePasses) {
  const Admission admission = admit(keyframeFive(), graphWithKeyframes({3, 4}));
  EXPECT_TRUE(admission.accepted);
  EXPECT_FALSE(admission.bridged);
  EXPECT_EQ(admission.relative_poses.size(), 1U);
  EXPECT_TRUE(admission.refused.empty());
  EXPECT_FALSE(admission.has_up);
}

TEST(AdmissionTest, KeyframesThatCannotBePlacedAreRefusedWithAReason) {
  const std::vector<std::pair<std::function<void(Keyframe&)>, std::string>> faults = {
      {[](Keyframe& k) { k.id = KeyframeId{4}; }, "not above the newest, k4"},
      {[](Keyframe& k) { k.id = KeyframeId{2}; }, "not above the newest"},
      {[](Keyframe& k) { k.id = KeyframeId{-3}; }, "negative"},
      {[](Keyframe& k) { k.time = Time{4001}; }, "not after"},
      {[](Keyframe& k) { k.T_odom_body.translation.y() = kNan; }, "T_odom_body"},
      {[](Keyframe& k) { k.T_odom_body.rotation.coeffs() *= 2.0; }, "T_odom_body"}};
  for (const auto& [change, reason] : faults) {
    Keyframe keyframe = keyframeFive();
    change(keyframe);
    const Admission admission = admit(keyframe, graphWithKeyframes({3, 4}));
    EXPECT_FALSE(admission.accepted) << reason;
    EXPECT_TRUE(admission.relative_poses.empty());
    EXPECT_THAT(admission.refused, ElementsAre(HasSubstr(reason)));
  }
}

TEST(AdmissionTest, UnusableMeasurementsAreRefusedAndTheKeyframeIsBridged) {
  const std::vector<std::pair<std::function<void(RelativePose&)>, std::string>> faults = {
      {[](RelativePose& z) { z.from = KeyframeId{9}; }, "k9, which is not in the graph"},
      {[](RelativePose& z) { z.from = z.to; }, "itself"},
      {[](RelativePose& z) { z.from = KeyframeId{3}, z.to = KeyframeId{4}; }, "not about the keyframe"},
      {[](RelativePose& z) { z.kind = static_cast<RelativePoseKind>(17); }, "unknown kind"},
      {[](RelativePose& z) { z.T_from_to.translation.x() = kNan; }, "T_from_to"},
      {[](RelativePose& z) { z.covariance(2, 2) = kNan; }, "not finite"},
      {[](RelativePose& z) { z.covariance(2, 2) = -1; }, "positive definite"},
      {[](RelativePose& z) { z.covariance(2, 3) = 0.5; }, "symmetric"},
      {[](RelativePose& z) { z.covariance.setZero(); }, "positive definite"},
      {[](RelativePose& z) { z.covariance *= 1e12; }, "out of range"}};
  for (const auto& [change, reason] : faults) {
    Keyframe keyframe = keyframeFive();
    change(keyframe.relative_poses[0]);
    const Admission admission = admit(keyframe, graphWithKeyframes({3, 4}));
    EXPECT_TRUE(admission.accepted);
    EXPECT_TRUE(admission.bridged) << reason;
    EXPECT_THAT(admission.refused, ElementsAre(HasSubstr(reason)));
    ASSERT_EQ(admission.relative_poses.size(), 1U);
    EXPECT_EQ(admission.relative_poses[0].from, KeyframeId{4});
    EXPECT_DOUBLE_EQ(admission.relative_poses[0].T_from_to.translation.x(), 1.0);
  }
}

TEST(AdmissionTest, MeasurementGivenTwiceCountsOnce) {
  Keyframe keyframe = keyframeFive();
  keyframe.relative_poses.push_back(keyframe.relative_poses[0]);
  const Admission admission = admit(keyframe, graphWithKeyframes({3, 4}));
  EXPECT_EQ(admission.relative_poses.size(), 1U);
  EXPECT_THAT(admission.refused, ElementsAre(HasSubstr("measured twice")));
}

// A loop may be switched off by its robust loss; then nothing would hold the keyframe.
TEST(AdmissionTest, LoopAloneDoesNotTieAKeyframe) {
  Keyframe keyframe = keyframeFive();
  keyframe.relative_poses[0].kind = RelativePoseKind::kLoop;
  const Admission admission = admit(keyframe, graphWithKeyframes({3, 4}));
  EXPECT_TRUE(admission.bridged);
  EXPECT_EQ(admission.relative_poses.size(), 2U);
}

TEST(AdmissionTest, UpMustBeAUnitVectorWithASigma) {
  const auto admitted = [](const Eigen::Vector3d& up_body, double sigma_rad) {
    Keyframe keyframe = keyframeFive();
    keyframe.up_body = up_body;
    keyframe.up_sigma_rad = sigma_rad;
    return admit(keyframe, graphWithKeyframes({3, 4}));
  };
  EXPECT_TRUE(admitted(Eigen::Vector3d::UnitZ(), 0.01).has_up);
  for (const double sigma : {0.0, -1.0, kNan}) EXPECT_FALSE(admitted(Eigen::Vector3d::UnitZ(), sigma).has_up);
  EXPECT_FALSE(admitted({0, 0, 2}, 0.01).has_up);
  EXPECT_FALSE(admitted({0, kNan, 1}, 0.01).has_up);
  EXPECT_EQ(admitted({0, 0, 2}, 0.01).refused.size(), 1U);
  EXPECT_TRUE(admitted(Eigen::Vector3d::Zero(), 0.0).refused.empty()) << "unknown is not a fault";
}

TEST(BridgeCovarianceTest, WidensWithTheGap) {
  const Matrix6d near = bridgeCovariance({so3Exp({0, 0, 0.1}), {1, 0, 0}});
  const Matrix6d far = bridgeCovariance({so3Exp({0, 0, 1.0}), {5, 0, 0}});
  EXPECT_DOUBLE_EQ(std::sqrt(near(0, 0)), 0.15);
  EXPECT_DOUBLE_EQ(std::sqrt(near(5, 5)), 0.03);
  EXPECT_GT(far(0, 0), near(0, 0));
  EXPECT_GT(far(4, 4), near(4, 4));
}

}  // namespace
}  // namespace sgraphs
