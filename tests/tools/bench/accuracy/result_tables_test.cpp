#include "tools/bench/accuracy/result_tables.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/tools/bench/accuracy/results.h"

namespace sgraphs::bench {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TableSpec smallTable() {
  return {"ate", "ATE", "", {"cf1", "se1"}, {{"ours", "lidar-walls", "ate_m"}}};
}

TEST(ResultCellsTest, ShowMedianAndSpreadOverTheSeeds) {
  const std::vector<RunResult> results{resultOf("cf1", 1, "lidar-walls", {{"ate_m", 0.0123}}),
                                       resultOf("cf1", 2, "lidar-walls", {{"ate_m", 0.0101}}),
                                       resultOf("cf1", 3, "lidar-walls", {{"ate_m", 0.0222}})};
  EXPECT_THAT(
      resultCells(smallTable(), results),
      ElementsAre(ElementsAre("method", "cf1", "se1"), ElementsAre("ours", "0.0123 (0.0101–0.0222)", "–")));
}

TEST(ResultCellsTest, OneSeedHasNoSpread) {
  EXPECT_EQ(resultCells(smallTable(), {resultOf("cf1", 1, "lidar-walls", {{"ate_m", 12.3456}})})[1][1],
            "12.35");
}

TEST(ResultCellsTest, FewerSeedsThanThereAreAreSaid) {
  const std::vector<RunResult> results{resultOf("cf1", 1, "lidar-walls", {{"ate_m", 0.01}}),
                                       resultOf("cf1", 2, "lidar-walls", {{"ate_m", 0.02}}),
                                       resultOf("se1", 2, "lidar-walls", {{"ate_m", 0.03}})};
  EXPECT_THAT(resultCells(smallTable(), results)[1],
              ElementsAre("ours", "0.0150 (0.0100–0.0200)", "0.0300 [1]"));
}

TEST(ResultCellsTest, AMapThatIsNotCompleteIsMarked) {
  TableSpec table{"map", "Map", "map_completeness", {"a", "b"}, {{"ours", "encoder-walls", "map_rmse_m"}}};
  const std::vector<RunResult> results{
      resultOf("a", 1, "encoder-walls", {{"map_rmse_m", 0.02}, {"map_completeness", 0.95}}),
      resultOf("b", 1, "encoder-walls", {{"map_rmse_m", 0.02}, {"map_completeness", 0.89}})};
  EXPECT_THAT(resultCells(table, results)[1], ElementsAre("ours", "0.0200, 0.95", "0.0200, 0.89 *"));
}

TEST(PrintedCellsTest, HoldEverySystemOfThePaper) {
  const Cells ate = printedCells(ateTable({"walls"}, true, {}));
  ASSERT_EQ(ate.size(), 10u);
  EXPECT_THAT(ate[0], ElementsAre("method", "CF-1", "CF-2", "SE-1", "SE-2"));
  EXPECT_THAT(ate[6], ElementsAre("LeGO-LOAM", "–", "–", "–", "–"));
  EXPECT_THAT(ate[9], ElementsAre("S-Graph+", "0.03", "0.04", "0.02", "0.13"));
  const Cells map = printedCells(mapTable({"walls"}, true, {}));
  ASSERT_EQ(map.size(), 10u);
  EXPECT_THAT(map[9], ElementsAre("S-Graph+", "0.31", "0.33", "1.31"));
}

TEST(DetailCellsTest, ShowOnlyColumnsThatSomeRunHas) {
  const Cells cells = detailCells(
      {smallTable()}, {resultOf("cf1", 1, "lidar-walls", {{"ate_m", 0.01}, {"walls_missed", 2}})});
  EXPECT_THAT(cells[0], ElementsAre("scene", "run", "ATE [m]", "missed"));
  EXPECT_THAT(cells[1], ElementsAre("cf1", "lidar-walls", "0.0100", "2"));
  EXPECT_THAT(cells[2], ElementsAre("se1", "lidar-walls", "–", "–"));
}

TEST(FailuresTest, NameSceneSeedAndRun) {
  RunResult failed = resultOf("cf1", 2, "lidar-ndt", {});
  failed.failed = "lidar-ndt ended with code 139: ";
  EXPECT_THAT(failures({failed, resultOf("cf1", 1, "lidar-ndt", {})}),
              ElementsAre(HasSubstr("cf1, seed 2, lidar-ndt: lidar-ndt ended with code 139")));
}

TEST(AlignedTextTest, CountsCharactersNotBytes) {
  EXPECT_EQ(alignedText({{"a–b", "x"}, {"abcd", "y"}}), "a–b   x\nabcd  y\n");
}

TEST(MarkdownTest, UnderlinesItsHead) {
  EXPECT_EQ(markdown({{"a", "b"}, {"1", "2"}}), "| a | b |\n|---|---|\n| 1 | 2 |\n");
}

}  // namespace
}  // namespace sgraphs::bench
