#include "tools/eval/evaluate.h"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "common/base/error.h"
#include "tests/backend/output/synthetic_planes.h"
#include "tests/support/temp_folder.h"
#include "tests/tools/eval/synthetic_building.h"
#include "tools/eval/eval_report.h"

namespace sgraphs {
namespace {

struct Case {
  test::TempFolder folder;
  std::string out = folder / "out";
  std::string truth = folder / "truth";

  Case() {
    const auto run = test::makeSyntheticRun();
    writeOutputs(run->record, out);
    test::writeTruth(run->room, truth);
  }
};

template <typename Call>
std::string errorOf(const Call& call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(EvaluateTest, PerfectRunIsJudgedPerfect) {
  const Case c;
  const Evaluation e = evaluate(c.out, readTruth(c.truth));
  ASSERT_EQ(e.trajectories.size(), 3u);
  for (const auto& t : e.trajectories) {
    EXPECT_EQ(t.missing, "") << t.file;
    EXPECT_LT(t.absolute.translation_m.max, 1e-6) << t.file;
  }
  EXPECT_NEAR(e.trajectories[0].time_coverage, 13.9 / 13.99, 1e-9);
  EXPECT_LT(e.map.error.distance_m.rmse, 0.005);  // voxels around the room's edges
  EXPECT_EQ(e.calibration.at("odometry").count, 13u);
  EXPECT_NEAR(e.calibration.at("odometry").nees_translation, 0, 1e-9);
}

TEST(EvaluateTest, RoomsThePathEnteredAreAskedForCorridorsAreNot) {
  const Case c;
  const Truth truth = readTruth(c.truth);
  const auto asked = askedRooms(*truth.plan, truth.poses);
  ASSERT_EQ(asked.size(), 1u);
  EXPECT_EQ(asked[0].id, "R1");
}

TEST(EvaluateTest, TableSaysWhatIsMissingInTheGraph) {
  const Case c;
  const std::string table = evaluationTable(evaluate(c.out, readTruth(c.truth)));
  EXPECT_THAT(table, testing::HasSubstr("rooms     missing in this version's graph; the truth asks for 1\n"));
  EXPECT_THAT(table, testing::HasSubstr(
                         "walls     4 faces seen for 5 s or more: 0 found, 4 missed, 0 doubled; 4 others: "));
}

// From the graph through graph.json to the figures: walls with tilts and offsets of known size.
TEST(EvaluateTest, WallsAndTheirCovariancesAreJudgedAsTheGraphHasThem) {
  Case c;
  const auto run = test::makeSyntheticRun();
  test::addRoomPlanes(run->room, run->graph);
  for (auto& [id, plane] : run->graph.planes) {
    const TangentBasis uv = tangentBasis(plane.normal_map);
    plane.normal_map = (plane.normal_map + 1e-3 * uv.col(0) - 2e-3 * uv.col(1)).normalized();
    plane.offset_m = 3e-3;
    plane.covariance = Eigen::Vector3d(1e-6, 1e-6, 1e-6).asDiagonal();
    plane.covariance(0, 1) = plane.covariance(1, 0) = 0.6e-6;
  }
  for (const auto& [id, node] : run->graph.keyframes)
    run->record.keyframe_covariances[id] = Matrix6d::Identity() * 1e-6;
  writeOutputs(run->record, c.out);
  const Evaluation e = evaluate(c.out, readTruth(c.truth));
  EXPECT_EQ(e.walls.counts(true).faces, 4u);
  EXPECT_EQ(e.walls.counts(true).found, 4u);
  EXPECT_EQ(e.walls.counts(true).doubled, 0u);
  EXPECT_EQ(e.walls.counts(false).found, 0u);
  EXPECT_THAT(e.walls.false_walls, testing::IsEmpty());
  EXPECT_NEAR(e.walls.angle_rad.max, std::sqrt(5e-6), 1e-5);
  EXPECT_NEAR(e.walls.offset_m.max, 3e-3, 1e-5);
  EXPECT_EQ(e.estimates.pose.count, 13u);
  EXPECT_NEAR(e.estimates.pose.mean, 0, 1e-6);
  EXPECT_EQ(e.estimates.plane_tilt.count, 4u);
  // (1, -2) mrad under [1 0.6; 0.6 1] mrad^2: (1 + 4 + 2 * 0.6 * 2) / (1 - 0.36).
  EXPECT_NEAR(e.estimates.plane_tilt.mean, 7.4 / 0.64, 0.1);
  EXPECT_NEAR(e.estimates.plane_offset.median, 9, 0.1);
  EXPECT_THAT(evaluationTable(e), testing::HasSubstr("walls     4 in the graph, 0 of them false; angle"));
  const auto json = nlohmann::json::parse(evaluationJson(e));
  EXPECT_EQ(json["walls"]["asked"]["found"], 4);
  EXPECT_EQ(json["nees_of_estimates"]["plane_tilt"]["count"], 4);
}

TEST(EvaluateTest, IncompleteMapsDoNotCount) {
  const Case c;
  PointCloud map = readPlyPoints(c.out + "/map.ply");
  map.points.resize(map.points.size() / 4);
  map.floors.clear();
  writePlyPoints(c.out + "/map.ply", map);
  const Evaluation e = evaluate(c.out, readTruth(c.truth));
  EXPECT_FALSE(e.map.counts());
  EXPECT_THAT(evaluationTable(e), testing::HasSubstr("does NOT count (needs 0.90)"));
}

TEST(EvaluateTest, JsonHoldsTheFigures) {
  const Case c;
  const auto json = nlohmann::json::parse(evaluationJson(evaluate(c.out, readTruth(c.truth))));
  EXPECT_LT(json["trajectories"]["odometry.tum"]["ate_m"]["rmse"], 1e-6);
  EXPECT_EQ(json["trajectories"]["trajectory.tum"]["poses"], 140);
  EXPECT_TRUE(json["map"].contains("completeness"));
  EXPECT_EQ(json["layers"]["rooms"]["asked"], 1);
  EXPECT_EQ(json["nees"]["odometry"]["count"], 13);
}

TEST(EvaluateTest, OptionalTruthAndOutputsMayBeAbsent) {
  const Case c;
  std::filesystem::remove(c.truth + "/mesh.ply");
  std::filesystem::remove(c.truth + "/plan.json");
  std::filesystem::remove(c.out + "/keyframes.tum");
  std::filesystem::remove(c.out + "/graph.json");
  const std::string table = evaluationTable(evaluate(c.out, readTruth(c.truth)));
  EXPECT_THAT(table, testing::HasSubstr("map       not judged: the truth has no mesh.ply"));
  EXPECT_THAT(table, testing::HasSubstr("keyframes.tum   not judged: OUT has no such file"));
  EXPECT_THAT(table, testing::HasSubstr("NEES      not judged"));
  EXPECT_THAT(table, testing::HasSubstr("NEES of optimised poses   not judged"));
  EXPECT_THAT(table, testing::HasSubstr("NEES of optimised planes  not judged"));
  EXPECT_THAT(table, testing::HasSubstr("walls     not judged: OUT has no graph.json"));
}

TEST(EvaluateTest, WhatIsWrongIsSaidInOneLine) {
  const Case c;
  const Truth truth = readTruth(c.truth);
  EXPECT_THAT(errorOf([&] { evaluate(c.truth, truth); }), testing::HasSubstr("holds no trajectory.tum"));
  EXPECT_THAT(errorOf([&] { readTruth(c.out); }), testing::HasSubstr("holds no gt.tum"));
  EXPECT_THAT(errorOf([&] { readTruth(c.out + "/nowhere"); }), testing::HasSubstr("is no folder"));
  writeFile(c.truth + "/gt.tum.xz", "");
  std::filesystem::remove(c.truth + "/gt.tum");
  EXPECT_THAT(errorOf([&] { readTruth(c.truth); }), testing::HasSubstr("unpack gt.tum.xz"));
}

TEST(EvaluateTest, BrokenTruthIsNamed) {
  const Case c;
  writeFile(c.truth + "/mesh.ply", "not a mesh");
  EXPECT_THAT(errorOf([&] { readTruth(c.truth); }), testing::HasSubstr("mesh.ply"));
  writeFile(c.truth + "/plan.json", "{\"rooms\": [{}]}");
  EXPECT_THAT(errorOf([&] { readTruth(c.truth); }), testing::HasSubstr("plan.json"));
}

}  // namespace
}  // namespace sgraphs
