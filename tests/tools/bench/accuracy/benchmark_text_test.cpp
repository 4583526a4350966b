#include "tools/bench/accuracy/benchmark_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/tools/bench/accuracy/results.h"

namespace sgraphs::bench {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

const BenchmarkOrigin kOrigin{"sgraphs bench accuracy --seeds 2", "9.8.7", "abc123", "2024-01-31",
                              "Some CPU, 2 cores"};

std::string sectionOf(bool baselines) {
  return accuracySection({ateTable({"walls"}, baselines, {"cf1"})},
                         {resultOf("cf1", 4, "lidar-walls", {{"ate_m", 0.01}}),
                          resultOf("cf1", 7, "lidar-walls", {{"ate_m", 0.03}})},
                         kOrigin);
}

TEST(AccuracySectionTest, SaysHowItWasMade) {
  const std::string text = sectionOf(true);
  EXPECT_THAT(text, HasSubstr("    sgraphs bench accuracy --seeds 2\n"));
  EXPECT_THAT(text, HasSubstr("sgraphs 9.8.7, commit abc123 (program 0123456789ab), 2024-01-31; Some CPU, 2 "
                              "cores; seeds 4, 7; settings: the defaults."));
  EXPECT_THAT(text, HasSubstr("| sgraphs, --layers walls | 0.0200 (0.0100–0.0300) |"));
}

TEST(AccuracySectionTest, MarksThePapersFiguresAsTheirsOnTheirData) {
  EXPECT_THAT(sectionOf(true), HasSubstr("theirs, on their data"));
  EXPECT_THAT(sectionOf(true), HasSubstr("| S-Graph+ | 0.03 | 0.04 | 0.02 | 0.13 |"));
}

TEST(AccuracySectionTest, ExplainsBaselinesOnlyWhereTheyAre) {
  EXPECT_THAT(sectionOf(true), HasSubstr("**Baselines**"));
  EXPECT_THAT(sectionOf(false), Not(HasSubstr("**Baselines**")));
}

TEST(WithSectionTest, StartsAFileThatIsNotThere) {
  EXPECT_THAT(withSection("", sectionOf(false)), StartsWith("# Benchmark\n\n<!--"));
}

TEST(WithSectionTest, LeavesWhatOthersWroteAndReplacesItsOwn) {
  const std::string first = withSection("# Benchmark\nBy hand.\n", sectionOf(true));
  const std::string second = withSection(first + "## Speed\nfast\n", sectionOf(false));
  EXPECT_THAT(second, StartsWith("# Benchmark\nBy hand.\n"));
  EXPECT_THAT(second, HasSubstr("end -->\n## Speed\nfast\n"));
  EXPECT_THAT(second, Not(HasSubstr("**Baselines**")));
  EXPECT_EQ(withSection(second, sectionOf(false)), second);
}

TEST(MachineTextTest, NamesCoresAndMemory) {
  EXPECT_THAT(machineText(), HasSubstr(" cores, "));
  EXPECT_THAT(machineText(), HasSubstr(" GiB, "));
}

}  // namespace
}  // namespace sgraphs::bench
