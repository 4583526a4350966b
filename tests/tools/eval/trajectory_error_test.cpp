#include "tools/eval/trajectory_error.h"

#include <gtest/gtest.h>

#include "common/base/error.h"
#include "tests/tools/eval/truth_fixture.h"

namespace sgraphs {
namespace {

TEST(AbsoluteErrorTest, MovedCopyHasNone) {
  const auto truth = test::curvedTruth();
  const auto result = absoluteError(truth, test::everyNth(truth, 10, test::kSomeTransform));
  EXPECT_EQ(result.translation_m.count, 201u);
  EXPECT_LT(result.translation_m.max, 1e-9);
  EXPECT_LT(result.T_truth_map.rotation.angularDistance(test::kSomeTransform.inverse().rotation), 1e-7);
}

// Worked out by hand for evo's definition (evo_ape tum -a: Umeyama without scale, translation part, RMSE):
// four corners of a square, two of them 10 cm too far out. By symmetry no rigid motion does better than none,
// so the distances are 0.1, 0, 0.1, 0 m and their RMSE is sqrt(0.02 / 4) m.
TEST(AbsoluteErrorTest, EqualsEvosDefinitionOnASquare) {
  std::vector<StampedPose> truth, estimate;
  const Eigen::Vector3d corners[] = {{1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}};
  for (int i = 0; i < 4; ++i) {
    const Time time{1'000'000 + 100'000 * i};
    const double out = i % 2 == 0 ? 1.1 : 1.0;
    truth.push_back({time, {Eigen::Quaterniond::Identity(), corners[i]}});
    estimate.push_back({time, test::kSomeTransform * SE3(Eigen::Quaterniond::Identity(), out * corners[i])});
  }
  const AbsoluteError error = absoluteError(truth, estimate);
  EXPECT_NEAR(error.translation_m.rmse, std::sqrt(0.02 / 4), 1e-9);
  EXPECT_NEAR(error.translation_m.max, 0.1, 1e-9);
  // With equal stamps the nearest one is the interpolated one.
  EXPECT_NEAR(absoluteErrorNearestStamp(truth, estimate)->rmse, std::sqrt(0.02 / 4), 1e-9);
}

TEST(AbsoluteErrorTest, ScaleIsNotForgiven) {
  const auto truth = test::curvedTruth();
  auto estimate = truth;
  for (auto& pose : estimate) pose.pose.translation *= 1.1;
  EXPECT_GT(absoluteError(truth, estimate).translation_m.rmse, 0.1);
}

TEST(AbsoluteErrorTest, MirrorImagesAreNotAligned) {
  const auto truth = test::curvedTruth();
  auto estimate = truth;
  for (auto& pose : estimate) pose.pose.translation.z() *= -1;
  EXPECT_GT(absoluteError(truth, estimate).translation_m.rmse, 0.05);
}

TEST(AbsoluteErrorTest, WhiteNoiseHasItsOwnSize) {
  const auto truth = test::curvedTruth();
  auto estimate = test::everyNth(truth, 1, test::kSomeTransform);
  std::mt19937 random(3);
  for (auto& pose : estimate) pose.pose.translation += test::gaussian(random, 0.02);
  const auto result = absoluteError(truth, estimate).translation_m;
  EXPECT_NEAR(result.rmse, 0.02 * std::sqrt(3.0), 0.001);
  EXPECT_LT(result.median, result.rmse);
  EXPECT_LT(result.rmse, result.max);
}

TEST(AbsoluteErrorTest, TruthIsInterpolatedWhereEvoTakesTheNearestStamp) {
  auto truth = test::curvedTruth();
  std::vector<StampedPose> estimate;
  // Stamps half-way between the truth's rows.
  for (size_t i = 10; i + 10 < truth.size(); i += 10) {
    const Time time = truth[i].time + Duration{5'000};
    estimate.push_back({time, test::kSomeTransform * *poseAt(truth, time)});
  }
  EXPECT_LT(absoluteError(truth, estimate).translation_m.rmse, 1e-9);
  // Half a row of motion at about 1 m/s, partly taken up by the alignment.
  const double evo = absoluteErrorNearestStamp(truth, estimate)->rmse;
  EXPECT_GT(evo, 1e-5);
  EXPECT_LT(evo, 6e-3);
}

TEST(AbsoluteErrorTest, EvoPairsTheShorterTrajectoryWithinTenMilliseconds) {
  const auto truth = test::curvedTruth();
  auto estimate = test::everyNth(truth, 100, SE3{});
  estimate[5].time = estimate[5].time + Duration{4'000};
  EXPECT_EQ(absoluteErrorNearestStamp(truth, estimate)->count, 21u);
  const auto sparse_truth = test::everyNth(truth, 50, SE3{});
  estimate = test::everyNth(truth, 100, SE3{});
  estimate[5].time = estimate[5].time + Duration{10'001};
  EXPECT_EQ(absoluteErrorNearestStamp(sparse_truth, estimate)->count, 20u);
  // The estimate is longer: each row of the truth looks for a partner.
  EXPECT_EQ(absoluteErrorNearestStamp(sparse_truth, truth)->count, sparse_truth.size());
}

TEST(AbsoluteErrorTest, PosesOutsideTheTruthsTimeAreLeftOut) {
  const auto truth = test::curvedTruth();
  auto estimate = test::everyNth(truth, 10, SE3{});
  estimate.push_back({truth.back().time + Duration{1'000'000}, SE3{}});
  EXPECT_EQ(absoluteError(truth, estimate).translation_m.count, 201u);
  EXPECT_THROW(absoluteError(truth, {{{0}, SE3{}}, {{1}, SE3{}}, {{2}, SE3{}}}), Error);
}

TEST(AbsoluteErrorTest, StraightLinesCannotBeAligned) {
  std::vector<Eigen::Vector3d> line(10);
  for (int i = 0; i < 10; ++i) line[static_cast<size_t>(i)] = {1.0 * i, 2.0 * i, 0};
  EXPECT_THROW(alignPoints(line, line), Error);
}

TEST(RelativeErrorTest, DriftPerMetreIsFound) {
  std::vector<StampedPose> truth, estimate;
  for (int i = 0; i <= 1000; ++i) {
    truth.push_back({{i * 10'000}, {Eigen::Quaterniond::Identity(), {0.01 * i, 0, 0}}});
    if (i % 10 == 0) estimate.push_back({{i * 10'000}, {Eigen::Quaterniond::Identity(), {0.0102 * i, 0, 0}}});
  }
  const auto per_metre = relativeErrorPerPath(truth, estimate, 1.0);
  ASSERT_TRUE(per_metre);
  EXPECT_NEAR(per_metre->translation_m.rmse, 0.02, 0.0025);  // pairs are 1.0 or, by rounding, 1.1 m apart
  EXPECT_NEAR(per_metre->rotation_rad.max, 0, 1e-9);
  const auto per_second = relativeErrorPerTime(truth, estimate, {1'000'000});
  ASSERT_TRUE(per_second);
  EXPECT_NEAR(per_second->translation_m.rmse, 0.02, 0.0025);
}

TEST(RelativeErrorTest, SparsePosesGiveNoPairs) {
  const auto truth = test::curvedTruth();
  EXPECT_FALSE(relativeErrorPerTime(truth, test::everyNth(truth, 500, SE3{}), {1'000'000}));
}

TEST(TimeCoverageTest, GapsAreNotCovered) {
  const auto truth = test::curvedTruth();
  auto estimate = test::everyNth(truth, 10, SE3{});
  EXPECT_DOUBLE_EQ(timeCoverage(truth, estimate, {200'000}), 1.0);
  // Two seconds of twenty are missing.
  estimate.erase(estimate.begin() + 51, estimate.begin() + 70);
  EXPECT_DOUBLE_EQ(timeCoverage(truth, estimate, {200'000}), 0.9);
}

TEST(TimeCoverageTest, StampsBeyondTheTruthCoverNothingMore) {
  const auto truth = test::curvedTruth();
  auto estimate = test::everyNth(truth, 10, SE3{});
  for (int i = 1; i <= 50; ++i) estimate.push_back({truth.back().time + Duration{i * 100'000}, SE3{}});
  EXPECT_DOUBLE_EQ(timeCoverage(truth, estimate, {200'000}), 1.0);
}

}  // namespace
}  // namespace sgraphs
