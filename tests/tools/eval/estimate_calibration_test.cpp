#include "tools/eval/estimate_calibration.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include "tests/tools/eval/truth_fixture.h"
#include "tests/tools/eval/two_rooms.h"

namespace sgraphs {
namespace {

using test::TwoRooms;

// Each keyframe misses the truth by what the function says, in its body; map is anywhere.
template <typename Error>
EstimatedGraph graphAlong(const std::vector<StampedPose>& truth, size_t step, const Matrix6d& covariance,
                          const Error& error) {
  EstimatedGraph graph;
  for (size_t i = 0; i < truth.size(); i += step) {
    const SE3 T_map_truth_body = test::kSomeTransform * truth[i].pose;
    const bool first = graph.keyframes.empty();
    // The truth is at exp(error) from the estimate.
    const Vector6d back = -error(graph.keyframes.size());
    const SE3 T_map_body = first ? T_map_truth_body : T_map_truth_body * se3Exp(back);
    graph.keyframes.push_back({truth[i].time, T_map_body, covariance});
  }
  return graph;
}

Matrix6d poseCovariance() {
  Matrix6d a = Matrix6d::Identity();
  for (int r = 0; r < 6; ++r)
    for (int c = 0; c < 6; ++c) a(r, c) += 0.1 * ((3 * r + 5 * c) % 7);
  return 1e-6 * a * a.transpose();
}

TEST(EstimateCalibrationTest, StatisticsAreMeanAndMedian) {
  const NeesStatistics s = neesStatistics(3, {5, 1, 3, 11});
  EXPECT_EQ(s.count, 4u);
  EXPECT_DOUBLE_EQ(s.mean, 5);
  EXPECT_DOUBLE_EQ(s.median, 4);
  EXPECT_EQ(neesStatistics(3, {}).count, 0u);
}

TEST(EstimateCalibrationTest, PosesAreJudgedFromTheFirstKeyframe) {
  const auto truth = test::curvedTruth();
  const Matrix6d covariance = 1e-4 * Matrix6d::Identity();
  Vector6d error;
  error << 0.01, 0, 0, 0, 0.02, 0;
  const auto result =
      calibrationOfEstimates(graphAlong(truth, 100, covariance, [&](size_t) { return error; }), truth, {});
  EXPECT_EQ(result.pose.count, 20u);
  EXPECT_NEAR(result.pose_translation.mean, 1, 0.05);
  EXPECT_NEAR(result.pose_rotation.mean, 4, 0.01);
  EXPECT_NEAR(result.pose.median, 5, 0.05);
  EXPECT_EQ(result.pose.dof, 6);
}

TEST(EstimateCalibrationTest, ErrorsDrawnFromTheirCovarianceAverageToTheDegreesOfFreedom) {
  const auto truth = test::curvedTruth();
  const Matrix6d covariance = poseCovariance();
  const Matrix6d root = covariance.llt().matrixL();
  std::mt19937 random(5);
  const auto result = calibrationOfEstimates(graphAlong(truth, 2, covariance,
                                                        [&](size_t) {
                                                          Vector6d white;
                                                          white << test::gaussian(random, 1),
                                                              test::gaussian(random, 1);
                                                          return Vector6d(root * white);
                                                        }),
                                             truth, {});
  ASSERT_EQ(result.pose.count, 1000u);
  EXPECT_NEAR(result.pose.mean, 6, 0.4);
  EXPECT_NEAR(result.pose.median, 5.348, 0.4);
  EXPECT_NEAR(result.pose_translation.mean, 3, 0.3);
  EXPECT_NEAR(result.pose_rotation.mean, 3, 0.3);
}

TEST(EstimateCalibrationTest, KeyframesWithoutCovarianceOrTruthAreLeftOut) {
  const auto truth = test::curvedTruth();
  EstimatedGraph graph =
      graphAlong(truth, 100, Matrix6d::Identity(), [](size_t) { return Vector6d(Vector6d::Zero()); });
  graph.keyframes[3].covariance.reset();
  graph.keyframes[4].time.us += int64_t{1'000'000'000};
  EXPECT_EQ(calibrationOfEstimates(graph, truth, {}).pose.count, 18u);
  graph.keyframes.front().time.us = 0;
  EXPECT_EQ(calibrationOfEstimates(graph, truth, {}).pose.count, 0u);
  EXPECT_EQ(calibrationOfEstimates({}, truth, {}).pose.count, 0u);
}

// A wall whose true face is reached by turns about its own axes and a shift along its normal.
TEST(EstimateCalibrationTest, PlanesAreJudgedInTheirOwnAxes) {
  const TwoRooms rooms;
  const MeshQuery mesh(rooms.mesh);
  const auto truth = TwoRooms::standing(10);
  const double tilt_u = 0.002, tilt_v = -0.001, offset_m = 0.009;
  std::vector<EstimatedWall> in_map;
  for (const TrueFace& face : trueFaces(rooms.plan, mesh)) {
    EstimatedWall wall = TwoRooms::wholeOf(face);
    const Eigen::Quaterniond turn =
        Eigen::AngleAxisd(tilt_u, wall.axis_u) * Eigen::AngleAxisd(tilt_v, wall.axis_v);
    // The estimate lies where these turns and the offset have not been made yet.
    wall = moved(wall, {turn.conjugate(), wall.centroid - turn.conjugate() * wall.centroid});
    wall = test::shifted(wall, -offset_m);
    wall.covariance << 1e-6, 0.5e-6, 0, 0.5e-6, 1e-6, 0, 0, 0, 9e-6;
    in_map.push_back(moved(wall, test::kSomeTransform));
  }
  EstimatedGraph graph;
  graph.keyframes.push_back({truth[0].time, test::kSomeTransform * truth[0].pose, {}});
  graph.walls = in_map;
  const WallResult judged = judgeWalls(rooms.plan, mesh, truth, in_map, test::kSomeTransform.inverse());
  const auto result = calibrationOfEstimates(graph, truth, judged);
  ASSERT_EQ(result.plane_tilt.count, 10u);
  // (2, -1) mrad under [1 0.5; 0.5 1] mrad^2: (4 + 1 + 2 * 0.5 * 2) / (1 - 0.25).
  EXPECT_NEAR(result.plane_tilt.mean, 7 / 0.75, 0.05);
  EXPECT_NEAR(result.plane_tilt.median, 7 / 0.75, 0.05);
  EXPECT_NEAR(result.plane_offset.mean, 9, 0.05);
  EXPECT_EQ(result.plane_tilt.dof, 2);
  EXPECT_EQ(result.plane_offset.dof, 1);
}

}  // namespace
}  // namespace sgraphs
