#include "tools/bench/accuracy/accuracy_bench.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "common/base/error.h"
#include "common/io/text_file.h"
#include "tests/support/temp_folder.h"
#include "tools/bench/accuracy/result_store.h"

namespace sgraphs::bench {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

// In place of sgraphs: says what it is asked to do in a file, and writes the files that are read. Its ATE is
// the seed.
constexpr char kProgram[] = R"(#!/bin/sh
here=$(dirname "$0")
echo "$@" >> "$here/calls"
case $1 in
  simulate) while [ $# -gt 0 ]; do [ "$1" = --seed ] && echo "$2" > "$here/seed"; shift; done ;;
  bench) [ -e "$here/break" ] && { echo out of luck; exit 1; }; mkdir -p "$5"; echo '{"duration_s": 7}' > "$5/summary.json" ;;
  replay) mkdir -p "$4"; echo '{"duration_s": 7, "reproducible": true}' > "$4/summary.json" ;;
  eval) echo "{\"trajectories\": {\"trajectory.tum\": {\"ate_m\": {\"rmse\": $(cat "$here/seed")}}}, \"walls\": {\"false\": [1, 2]}}" > "$2/eval.json" ;;
esac
)";

class AccuracyBenchTest : public ::testing::Test {
 protected:
  AccuracyBenchTest() {
    writeFile(folder_ / "program", kProgram);
    fs::permissions(folder_ / "program", fs::perms::owner_all);
    options_.work_dir = folder_ / "work";
    options_.program = folder_ / "program";
    options_.seeds = 2;
    options_.first_seed = 5;
    options_.tables = {{"ate",
                        "ATE",
                        "",
                        {SGRAPHS_SOURCE_DIR "/config/scenes/two_rooms"},
                        {{"ours", "lidar-walls", "ate_m"}, {"PCL", "lidar-gicp", "ate_m"}}}};
  }

  // How often the program was asked for this since the last time.
  int calls(const std::string& what) const {
    if (!fs::exists(folder_ / "calls")) return 0;
    const std::string text = "\n" + readFile(folder_ / "calls");
    int count = 0;
    for (size_t at = text.find("\n" + what); at != std::string::npos; at = text.find("\n" + what, at + 1))
      ++count;
    return count;
  }
  void forgetCalls() const { fs::remove(folder_ / "calls"); }

  test::TempFolder folder_;
  AccuracyOptions options_;
};

TEST_F(AccuracyBenchTest, RunsEveryRowOnTheSameRecordingOfEachSeed) {
  const auto results = runAccuracy(options_);
  ASSERT_EQ(results.size(), 4u);
  EXPECT_EQ(results[0].key.run, "lidar-walls");
  EXPECT_EQ(results[0].figure("ate_m"), 5.0);
  EXPECT_EQ(results[0].figure("walls_false"), 2.0);
  EXPECT_EQ(results[0].figure("duration_s"), 7.0);
  EXPECT_EQ(results[0].figure("reproducible"), 1.0);
  EXPECT_EQ(results[1].key.run, "lidar-gicp");
  EXPECT_EQ(results[3].figure("ate_m"), 6.0);
  EXPECT_FALSE(results[0].figure("map_rmse_m"));
  EXPECT_EQ(calls("simulate"), 2);
  EXPECT_EQ(calls("replay"), 2);
  EXPECT_EQ(calls("bench baseline"), 2);
  EXPECT_FALSE(fs::exists(options_.work_dir + "/recording_0")) << "recordings are large";
}

TEST_F(AccuracyBenchTest, ASecondRunMakesNothingAgain) {
  const auto first = runAccuracy(options_);
  forgetCalls();
  const auto second = runAccuracy(options_);
  EXPECT_EQ(calls(""), 0);
  ASSERT_EQ(second.size(), first.size());
  for (size_t i = 0; i < first.size(); ++i) {
    EXPECT_EQ(second[i].key, first[i].key);
    EXPECT_EQ(second[i].figures, first[i].figures);
  }
}

TEST_F(AccuracyBenchTest, AReportMeasuresNothing) {
  options_.seeds = 1;
  runAccuracy(options_);
  forgetCalls();
  options_.seeds = 2;
  options_.report_only = true;
  EXPECT_EQ(runAccuracy(options_).size(), 2u);
  EXPECT_EQ(calls(""), 0);
}

TEST_F(AccuracyBenchTest, FreshMakesEverythingAgain) {
  runAccuracy(options_);
  forgetCalls();
  options_.fresh = true;
  runAccuracy(options_);
  EXPECT_EQ(calls("replay"), 2);
}

TEST_F(AccuracyBenchTest, AnotherBuildCountsOnlyIfAskedFor) {
  runAccuracy(options_);
  forgetCalls();
  writeFile(folder_ / "program", std::string(kProgram) + "# changed\n");
  options_.any_program = true;
  runAccuracy(options_);
  EXPECT_EQ(calls("replay"), 0);
  options_.any_program = false;
  runAccuracy(options_);
  EXPECT_EQ(calls("replay"), 2);
}

TEST_F(AccuracyBenchTest, GoesOnWhereARunFailedAndTriesItAgainNextTime) {
  writeFile(folder_ / "break", "");
  const auto results = runAccuracy(options_);
  ASSERT_EQ(results.size(), 4u);
  EXPECT_TRUE(results[0].failed.empty());
  EXPECT_THAT(results[1].failed, HasSubstr("ended with code 1: out of luck"));
  fs::remove(folder_ / "break");
  forgetCalls();
  EXPECT_TRUE(runAccuracy(options_)[1].failed.empty());
  EXPECT_EQ(calls("replay"), 0);
  EXPECT_EQ(calls("bench baseline"), 2);
}

TEST_F(AccuracyBenchTest, TwoJobsGiveTheResultsOfOne) {
  options_.seeds = 1;  // the program above keeps one seed at a time
  const auto one = runAccuracy(options_);
  options_.jobs = 2;
  options_.fresh = true;
  const auto two = runAccuracy(options_);
  ASSERT_EQ(one.size(), two.size());
  for (size_t i = 0; i < one.size(); ++i) EXPECT_EQ(one[i].key, two[i].key);
}

TEST_F(AccuracyBenchTest, ProgressReachesItsTotal) {
  std::vector<size_t> finished;
  options_.on_progress = [&](const AccuracyProgress& p) {
    EXPECT_EQ(p.total, 4u);
    finished.push_back(p.finished);
  };
  runAccuracy(options_);
  EXPECT_THAT(finished, ::testing::ElementsAre(1u, 2u, 3u, 4u));
}

TEST_F(AccuracyBenchTest, AResultThatIsCutOffIsNamed) {
  const auto results = runAccuracy(options_);
  const std::string path = ResultStore(options_.work_dir + "/results", false).pathOf(results[0].key);
  writeFile(path, "{\"schema\": ");
  try {
    runAccuracy(options_);
    FAIL() << "read half a file";
  } catch (const Error& e) {
    EXPECT_THAT(e.what(), HasSubstr(path));
  }
}

TEST(FiguresTest, AMeanOverNoPosesIsNone) {
  test::TempFolder out;
  const auto withCount = [&](int count) {
    writeFile(out / "summary.json", "{}");
    writeFile(out / "eval.json", R"({"nees_of_estimates": {"pose_translation": {"mean": 2.5, "count": )" +
                                     std::to_string(count) + "}}}");
    return figuresOf(out.path());
  };
  EXPECT_FALSE(withCount(0).contains("pose_nees_translation"));
  EXPECT_EQ(withCount(7).at("pose_nees_translation"), 2.5);
}

TEST(SceneDigestTest, ChangesWithThePlan) {
  test::TempFolder folder;
  const std::string plan = readFile(SGRAPHS_SOURCE_DIR "/config/scenes/two_rooms/plan.json");
  writeFile(folder / "plan.json", plan);
  const std::string before = sceneDigest(folder / "plan.json");
  EXPECT_EQ(before, sceneDigest(SGRAPHS_SOURCE_DIR "/config/scenes/two_rooms/plan.json"));
  writeFile(folder / "plan.json", plan + " ");
  EXPECT_NE(before, sceneDigest(folder / "plan.json"));
}

}  // namespace
}  // namespace sgraphs::bench
