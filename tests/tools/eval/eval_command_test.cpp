#include <gmock/gmock.h>

#include "common/base/error.h"
#include "tests/support/temp_folder.h"
#include "tests/tools/eval/synthetic_building.h"
#include "tools/cli/commands.h"

namespace sgraphs {
namespace {

TEST(EvalCommandTest, WritesTableJsonAndPlots) {
  const test::TempFolder folder;
  const std::string out = folder / "out", truth = folder / "truth";
  const auto run = test::makeSyntheticRun();
  writeOutputs(run->record, out);
  test::writeTruth(run->room, truth);
  CLI::App app;
  cli::addEval(app);
  testing::internal::CaptureStdout();
  app.parse("eval " + out + " --truth " + truth);
  EXPECT_THAT(testing::internal::GetCapturedStdout(), testing::HasSubstr("trajectory.tum"));
  for (const char* file :
       {"eval.json", "eval_trajectory.png", "eval_error.png", "eval_map.png", "eval_walls.png"})
    EXPECT_GT(readFile(out + "/" + file).size(), 500u) << file;
}

TEST(EvalCommandTest, TruthIsRequired) {
  CLI::App app;
  cli::addEval(app);
  EXPECT_THROW(app.parse("eval somewhere"), CLI::RequiredError);
}

TEST(EvalCommandTest, EmptyOutIsAnError) {
  const test::TempFolder folder;
  const std::string out = folder / "out", truth = folder / "truth";
  createFolder(out);
  test::writeTruth(test::BoxRoom{}, truth);
  CLI::App app;
  cli::addEval(app);
  EXPECT_THROW(app.parse("eval " + out + " --truth " + truth), Error);
}

}  // namespace
}  // namespace sgraphs
