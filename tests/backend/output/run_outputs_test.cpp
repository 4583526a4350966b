#include "backend/output/run_outputs.h"

#include <gmock/gmock.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "common/base/error.h"
#include "common/io/ply.h"
#include "common/io/text_file.h"
#include "common/io/tum.h"
#include "tests/backend/output/synthetic_run.h"
#include "tests/support/temp_folder.h"

namespace sgraphs {
namespace {

std::vector<std::string> filesIn(const std::string& folder) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    names.push_back(entry.path().filename().string());
  return names;
}

TEST(RunOutputsTest, WritesEveryFileOfTheContract) {
  const auto run = test::makeSyntheticRun();
  const test::TempFolder folder;
  const std::string out = folder / "a/nested";
  writeOutputs(run->record, out);
  EXPECT_THAT(filesIn(out),
              testing::UnorderedElementsAre("trajectory.tum", "keyframes.tum", "odometry.tum", "map.ply",
                                            "graph.json", "graph.g2o", "floorplan_f0.svg", "floorplan_f0.png",
                                            "occupancy_f0.pgm", "occupancy_f0.yaml", "summary.json"));
  EXPECT_EQ(readTum(out + "/trajectory.tum").size(), 140u);
  EXPECT_EQ(readTum(out + "/keyframes.tum").size(), 14u);
  EXPECT_EQ(readTum(out + "/odometry.tum").size(), 140u);
}

TEST(RunOutputsTest, SameGraphGivesTheSameBytes) {
  const test::TempFolder folder;
  const std::string a = folder / "a", b = folder / "b";
  writeOutputs(test::makeSyntheticRun()->record, a);
  writeOutputs(test::makeSyntheticRun()->record, b);
  for (const std::string& name : filesIn(a))
    EXPECT_EQ(readFile(a + "/" + name), readFile(b + "/" + name)) << name;
}

TEST(RunOutputsTest, MapPointsLieOnTheRoomAndNameTheirStorey) {
  const auto run = test::makeSyntheticRun();
  const test::TempFolder folder;
  const std::string& out = folder.path();
  writeOutputs(run->record, out);
  const PointCloud map = readPlyPoints(out + "/map.ply");
  ASSERT_GT(map.points.size(), 10000u);
  EXPECT_THAT(map.floors, testing::Each(0));
  for (const auto& p : map.points) {
    // Centroids of voxels that reach around an edge of the room leave both faces by less than a voxel.
    const Eigen::Vector3d to_faces =
        (p.cast<double>() - run->room.min).cwiseAbs().cwiseMin((p.cast<double>() - run->room.max).cwiseAbs());
    ASSERT_LT(to_faces.minCoeff(), 0.03);
  }
}

TEST(RunOutputsTest, SummaryCarriesTheFactsOfTheRun) {
  const auto run = test::makeSyntheticRun();
  run->record.graph_digest = "abc";
  run->record.reproducible = false;
  run->record.why_not = "a message of KEYFRAME is lost";
  run->record.stages["odometry"] = {1.5, 4.5, 9.5, 140};
  run->record.factors["odometry"] = {13, 78, 70.25};
  run->record.gaps["KEYFRAME"] = 1;
  const test::TempFolder folder;
  const std::string& out = folder.path();
  writeOutputs(run->record, out);
  const auto json = nlohmann::json::parse(readFile(out + "/summary.json"));
  for (const char* key :
       {"version", "config_digest", "input_digest", "wall_s", "realtime_factor", "peak_rss_mib"})
    EXPECT_TRUE(json.contains(key)) << key;
  EXPECT_EQ(json["graph_digest"], "abc");
  EXPECT_EQ(json["reproducible"], false);
  EXPECT_EQ(json["why_not"], "a message of KEYFRAME is lost");
  EXPECT_EQ(json["duration_s"], 13.9);
  EXPECT_EQ(json["stages"]["odometry"],
            nlohmann::json({{"p50_ms", 1.5}, {"p99_ms", 4.5}, {"max_ms", 9.5}, {"count", 140}}));
  EXPECT_EQ(json["factors"]["odometry"], nlohmann::json({{"count", 13}, {"dof", 78}, {"chi2", 70.25}}));
  EXPECT_EQ(json["gaps"]["KEYFRAME"], 1);
}

TEST(RunOutputsTest, RunWithoutKeyframesWritesWhatThereIs) {
  const SituationalGraph graph;
  RunRecord record;
  record.graph = &graph;
  const test::TempFolder folder;
  const std::string& out = folder.path();
  writeOutputs(record, out);
  EXPECT_THAT(filesIn(out),
              testing::UnorderedElementsAre("trajectory.tum", "keyframes.tum", "odometry.tum", "map.ply",
                                            "graph.json", "graph.g2o", "summary.json"));
}

TEST(RunOutputsTest, UnwritableFolderIsNamed) {
  const auto run = test::makeSyntheticRun();
  const test::TempFolder folder;
  const std::string file = folder / "file";
  writeFile(file, "");
  try {
    writeOutputs(run->record, file + "/out");
    FAIL() << "a folder below a file was written";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr(file + "/out"));
  }
}

}  // namespace
}  // namespace sgraphs
