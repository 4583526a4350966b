#include "tools/eval/calibration.h"

#include <gmock/gmock.h>

#include <Eigen/Cholesky>

#include "backend/output/graph_files.h"
#include "common/base/error.h"
#include "common/io/text_file.h"
#include "tests/support/temp_folder.h"
#include "tests/tools/eval/truth_fixture.h"

namespace sgraphs {
namespace {

Matrix6d someCovariance() {
  Matrix6d root = Matrix6d::Identity() * 0.01;
  root(1, 0) = 0.004;
  root(5, 0) = 0.003;
  root(4, 3) = -0.002;
  return root * root.transpose();
}

// Measurements between neighbours of the truth whose errors are drawn from `scale` times the covariance.
std::vector<MeasuredLink> drawLinks(const std::vector<StampedPose>& truth, const Matrix6d& covariance,
                                    double scale) {
  const Matrix6d root = covariance.llt().matrixL();
  std::mt19937 random(5);
  std::vector<MeasuredLink> links;
  for (int repeat = 0; repeat < 10; ++repeat)
    for (size_t i = 10; i < truth.size(); i += 10) {
      Vector6d white;
      white << test::gaussian(random, scale), test::gaussian(random, scale);
      const SE3 T_from_to = truth[i - 10].pose.inverse() * truth[i].pose;
      // T_true = T_measured * exp(delta)
      links.push_back(
          {"odometry", truth[i - 10].time, truth[i].time, T_from_to * se3Exp(-root * white), covariance});
    }
  return links;
}

TEST(CalibrationTest, ExactGaussiansGiveThreeAndNinetyFivePercent) {
  const auto truth = test::curvedTruth();
  const Calibration c = calibrationOf(drawLinks(truth, someCovariance(), 1), truth).at("odometry");
  EXPECT_EQ(c.count, 2000u);
  // The mean of 2000 chi-squared values of 3 dof has a deviation of 0.055.
  EXPECT_NEAR(c.nees_translation, 3, 0.2);
  EXPECT_NEAR(c.nees_rotation, 3, 0.2);
  EXPECT_NEAR(c.inside_translation, 0.95, 0.02);
  EXPECT_NEAR(c.inside_rotation, 0.95, 0.02);
}

TEST(CalibrationTest, DoubledErrorsGiveFourTimesAsMuch) {
  const auto truth = test::curvedTruth();
  const Calibration c = calibrationOf(drawLinks(truth, someCovariance(), 2), truth).at("odometry");
  EXPECT_NEAR(c.nees_translation, 12, 0.8);
  EXPECT_LT(c.inside_translation, 0.7);
}

TEST(CalibrationTest, LinksOutsideTheTruthsTimeAreLeftOut) {
  const auto truth = test::curvedTruth();
  EXPECT_TRUE(calibrationOf({{"loop", {0}, {1}, SE3{}, Matrix6d::Identity()}}, truth).empty());
}

TEST(CalibrationTest, LinksAreReadAsTheRunWritesThem) {
  SituationalGraph graph;
  graph.keyframes[{3}] = {{3}, {100}, SE3{}, SE3{}, {}, nullptr};
  graph.keyframes[{4}] = {{4}, {200}, SE3{}, SE3{}, {}, nullptr};
  graph.relative_poses.push_back(
      {0, {RelativePoseKind::kNeighbour, {3}, {4}, test::kSomeTransform, someCovariance()}});
  const test::TempFolder folder;
  const std::string path = folder / "graph.json";
  writeFile(path, graphJson(graph, {}));
  const auto links = readMeasuredLinks(path);
  ASSERT_EQ(links.size(), 1u);
  EXPECT_EQ(links[0].kind, "neighbour");
  EXPECT_EQ(links[0].from.us, 100);
  EXPECT_EQ(links[0].to.us, 200);
  EXPECT_EQ(links[0].T_from_to.translation, test::kSomeTransform.translation);
  EXPECT_EQ(links[0].covariance, someCovariance());
}

// The truth is of the last walk; at the same stamps an earlier one was elsewhere.
TEST(CalibrationTest, LinksOfEarlierSessionsAreLeftOut) {
  SituationalGraph graph;
  graph.keyframes[{3}] = {{3}, {100}, SE3{}, SE3{}, {}, nullptr};
  graph.keyframes[{4}] = {{4}, {200}, SE3{}, SE3{}, {}, nullptr};
  graph.keyframes[{5}] = {{5}, {300}, SE3{}, SE3{}, {}, nullptr};
  for (const int64_t from : {3, 4})
    graph.relative_poses.push_back(
        {from, {RelativePoseKind::kNeighbour, {from}, {from + 1}, test::kSomeTransform, someCovariance()}});
  const test::TempFolder folder;
  const std::string path = folder / "graph.json";
  const std::vector<SessionClock> sessions = {{{3}, {100}, {}}, {{4}, {200}, {150}}};
  writeFile(path, graphJson(graph, {}, {}, sessions));
  const auto links = readMeasuredLinks(path);
  ASSERT_EQ(links.size(), 1u);
  EXPECT_EQ(links[0].from.us, 50) << "by its recording's own clock";
  EXPECT_EQ(links[0].to.us, 150);
}

TEST(CalibrationTest, BrokenGraphsAreNamed) {
  const test::TempFolder folder;
  const std::string path = folder / "graph.json";
  for (const char* text : {"{", "{\"links\":[]}"}) {
    writeFile(path, text);
    try {
      readMeasuredLinks(path);
      FAIL() << text;
    } catch (const Error& error) {
      EXPECT_THAT(error.what(), testing::HasSubstr(path));
    }
  }
}

}  // namespace
}  // namespace sgraphs
