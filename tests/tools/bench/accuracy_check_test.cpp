// Short walks through the whole program: fails where it became worse by more than noise explains. Limits and
// what they were taken from stand in accuracy_limits.json.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "common/io/text_file.h"
#include "tests/support/temp_folder.h"
#include "tools/bench/accuracy/accuracy_bench.h"

namespace sgraphs::bench {
namespace {

using Json = nlohmann::json;

const RunResult* find(const std::vector<RunResult>& results, const Json& limit) {
  for (const RunResult& result : results)
    if (result.key.scene == SGRAPHS_SOURCE_DIR "/config/scenes/" + limit["scene"].get<std::string>() &&
        result.key.run == limit["run"])
      return &result;
  return nullptr;
}

// One table for each run of each scene, as far as a limit asks for it.
std::vector<TableSpec> tablesFor(const Json& limits) {
  std::vector<TableSpec> tables;
  for (const Json& limit : limits)
    tables.push_back({"check",
                      "check",
                      "",
                      {SGRAPHS_SOURCE_DIR "/config/scenes/" + limit["scene"].get<std::string>()},
                      {{"", limit["run"], limit["figure"]}}});
  return tables;
}

TEST(AccuracyCheckTest, NoFigureIsBeyondItsLimit) {
#if !defined(NDEBUG) || defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "minutes of walking take too long without optimisation or under a sanitizer";
#endif
  test::TempFolder folder;
  const Json limits =
      Json::parse(readFile(SGRAPHS_SOURCE_DIR "/tests/tools/bench/accuracy_limits.json")).at("limits");
  AccuracyOptions options;
  options.work_dir = folder / "work";
  options.program = SGRAPHS_BINARY_DIR "/sgraphs";
  options.tables = tablesFor(limits);
  options.seeds = 1;
  const std::vector<RunResult> results = runAccuracy(options);
  for (const Json& limit : limits) {
    const std::string what = limit["scene"].get<std::string>() + ", " + limit["run"].get<std::string>() +
                             ", " + limit["figure"].get<std::string>();
    const RunResult* result = find(results, limit);
    ASSERT_NE(result, nullptr) << what;
    EXPECT_EQ(result->failed, "") << what;
    const auto value = result->figure(limit["figure"]);
    if (!value) {
      ADD_FAILURE() << what << ": not judged";
      continue;
    }
    EXPECT_LE(*value, limit.value("max", *value)) << what;
    EXPECT_GE(*value, limit.value("min", *value)) << what;
  }
}

}  // namespace
}  // namespace sgraphs::bench
