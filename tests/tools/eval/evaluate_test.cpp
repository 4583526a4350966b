#include "tools/eval/evaluate.h"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "common/base/error.h"
#include "tests/backend/output/synthetic_planes.h"
#include "tests/support/temp_folder.h"
#include "tests/tools/eval/house.h"
#include "tests/tools/eval/synthetic_building.h"
#include "tools/eval/eval_plots.h"
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
  EXPECT_THAT(askedRooms(*truth.plan, roomVisits(*truth.plan, truth.poses)),
              testing::ElementsAre(true, false, false));
}

TEST(EvaluateTest, TableSaysWhatIsMissingInTheGraph) {
  const Case c;
  const std::string table = evaluationTable(evaluate(c.out, readTruth(c.truth)));
  EXPECT_THAT(table, testing::HasSubstr(
                         "rooms     missing in this run: graph.json holds no rooms; the truth asks for 1\n"));
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
  EXPECT_EQ(json["rooms"]["asked"], 1);
  EXPECT_TRUE(json["rooms"]["recall"].is_null());
  EXPECT_EQ(json["rooms"]["missing"], "missing in this run: graph.json holds no rooms");
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

TEST(EvaluateTest, GlazedWindowsOfThePlanArePanes) {
  const Case c;
  writeFile(c.truth + "/plan.json", R"({"floors": [0],
      "walls": [{"a": [0, 0], "b": [0, 6], "thickness": 0.2, "z": [0, 3]}],
      "windows": [{"xyz": [0, 2, 0.9], "width": 1.2, "height": 1.3, "glazed": true},
                  {"xyz": [0, 4, 0.9], "width": 1.2, "height": 1.3}]})");
  const Plan plan = *readTruth(c.truth).plan;
  ASSERT_EQ(plan.panes.size(), 1u);
  EXPECT_TRUE(plan.panes[0].a.isApprox(Eigen::Vector2d(0, 1.4), 1e-9));
  EXPECT_TRUE(plan.panes[0].b.isApprox(Eigen::Vector2d(0, 2.6), 1e-9));
  EXPECT_DOUBLE_EQ(plan.panes[0].z_low_m, 0.9);
  EXPECT_DOUBLE_EQ(plan.panes[0].z_high_m, 2.2);
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

struct HouseCase {
  test::TempFolder folder;
  std::string out = folder / "out";
  std::string truth = folder / "truth";
  test::House house;
  EstimatedGraph graph = house.graph(test::kMapOfHouse);

  Evaluation judge() {
    test::writeHouse(house, graph, test::kMapOfHouse, out, truth);
    return evaluate(out, readTruth(truth));
  }
};

TEST(EvaluateTest, RoomsFloorsAndDoorwaysAreJudged) {
  HouseCase c;
  c.graph.rooms[0].accepted = test::House::kStart + Duration{4'000'000};
  c.graph.rooms[4].polygon.pop_back();
  c.graph.rooms[4].polygon.pop_back();
  c.graph.doorways.pop_back();
  const Evaluation e = c.judge();
  const std::string table = evaluationTable(e);
  EXPECT_THAT(table,
              testing::HasSubstr("rooms     3 asked for: 2 found, 1 missed; 5 in the graph, 1 of them false; "
                                 "recall 0.667, precision 0.750; mean IoU 1.000"));
  EXPECT_THAT(table, testing::HasSubstr("rooms     missed: U1\n"));
  EXPECT_THAT(table, testing::HasSubstr("rooms     false: r4 (has less than three corners)\n"));
  EXPECT_THAT(table,
              testing::HasSubstr("time to detection median 4.0 s, max 4.0 s, over 1 of 1 rooms occupied"));
  EXPECT_THAT(table,
              testing::HasSubstr("floors    2 asked for: 2 found, 0 missed; 2 in the graph, 0 of them false; "
                                 "storey 0 (0.00 m): "));
  EXPECT_THAT(table, testing::HasSubstr("floors    ATE: storey 0 (0.00 m) 0.0000 m ("));
  EXPECT_THAT(table, testing::HasSubstr(
                         "doorways  found: walked through 3 of 3, of rooms asked for 4 of 4, all 4 of 5; "
                         "4 in the graph, 0 of them false; precision 1.000; off by"));
  const auto json = nlohmann::json::parse(evaluationJson(e));
  EXPECT_NEAR(json["rooms"]["recall"], 2.0 / 3, 1e-12);
  EXPECT_EQ(json["rooms"]["missed"], nlohmann::json::array({"U1"}));
  EXPECT_EQ(json["rooms"]["false"][0]["id"], "r4");
  EXPECT_EQ(json["rooms"]["detection_s"]["median"], 4.0);
  EXPECT_EQ(json["floors"]["recall"], 1.0);
  EXPECT_EQ(json["floors"]["ate_by_storey"].size(), 3u);
  EXPECT_EQ(json["doorways"]["of_asked_rooms"]["recall"], 1.0);
  const auto plots = evaluationPlots(e, readTruth(c.truth));
  for (const std::string kind : {"rooms", "trajectory"})
    EXPECT_EQ(std::count_if(plots.begin(), plots.end(),
                            [&](const auto& plot) { return plot.first.starts_with("eval_" + kind + "_"); }),
              2)
        << kind << ": one picture per storey";
}

TEST(PlanViewTest, WhatStandsOnAFloorIsOnItsStoreyAndOnNoOther) {
  const std::vector<double> floors = {0.0, -3.0, 3.2};  // in any order
  EXPECT_TRUE(isOn(0, 0.5, floors));
  EXPECT_TRUE(isOn(0, 3.1 - 0.3, floors));
  EXPECT_TRUE(isOn(2, 3.1, floors)) << "a map's floor may lie lower than the building's";
  EXPECT_TRUE(isOn(1, -0.5, floors));
  EXPECT_FALSE(isOn(2, 0.5, floors));
  EXPECT_FALSE(isOn(0, 4.0, floors));
  EXPECT_TRUE(isOn(0, -9.0, floors)) << "below all: of the first";
  EXPECT_TRUE(isOn({}, 4.0, floors)) << "all storeys on top of each other";
}

TEST(EvaluateTest, LayersThatARunDoesNotMakeAreMissingNotZero) {
  HouseCase c;
  c.graph.rooms.clear();
  c.graph.doorways.clear();
  const Evaluation e = c.judge();
  EXPECT_THAT(evaluationTable(e),
              testing::HasSubstr(
                  "doorways  missing in this run: graph.json holds no doorways; the truth asks for 4\n"));
  const auto json = nlohmann::json::parse(evaluationJson(e));
  EXPECT_TRUE(json["doorways"]["precision"].is_null());
  EXPECT_TRUE(json["rooms"]["found"].is_null());
  EXPECT_EQ(json["rooms"]["asked"], 3);
}

// Another program writes a trajectory and a map, nothing else; the truth is a mesh without a plan.
TEST(EvaluateTest, OutOfAnotherProgramIsJudged) {
  const Case c;
  for (const auto& entry : std::filesystem::directory_iterator(c.out))
    if (entry.path().filename() != "trajectory.tum" && entry.path().filename() != "map.ply")
      std::filesystem::remove_all(entry.path());
  writeFile(c.truth + "/plan.json", "{}");
  const Truth truth = readTruth(c.truth);
  const Evaluation e = evaluate(c.out, truth);
  EXPECT_LT(e.trajectories[0].absolute.translation_m.rmse, 1e-6);
  EXPECT_LT(e.map.error.distance_m.rmse, 0.005);
  EXPECT_GT(e.map.error.completeness, 0.5);
  const std::string table = evaluationTable(e);
  for (const char* layer : {"rooms", "floors", "doorways"})
    EXPECT_THAT(table,
                testing::HasSubstr(std::string("not judged: the truth has no plan.json with ") + layer));
  EXPECT_TRUE(nlohmann::json::parse(evaluationJson(e))["rooms"]["recall"].is_null());
  EXPECT_EQ(evaluationPlots(e, truth).size(), 3u);  // trajectory, error, map
}

TEST(EvaluateTest, RoomsOfAPlanAreCheckedWhenRead) {
  const Case c;
  writeFile(c.truth + "/plan.json",
            R"({"floors": [0], "rooms": [{"id": "A", "floor": 1, "polygon": [[0, 0], [1, 0], [1, 1]]}]})");
  EXPECT_THAT(errorOf([&] { readTruth(c.truth); }), testing::HasSubstr("room A is on floor 1 of 1"));
  writeFile(c.truth + "/plan.json",
            R"({"floors": [0], "rooms": [{"id": "A", "polygon": [[0, 0], [1, 1], [1, 0], [0, 1]]}]})");
  EXPECT_THAT(errorOf([&] { readTruth(c.truth); }), testing::HasSubstr("room A has an outline that crosses"));
}

}  // namespace
}  // namespace sgraphs
