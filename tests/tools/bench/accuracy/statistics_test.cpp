#include "tools/bench/accuracy/statistics.h"

#include <gtest/gtest.h>

#include "tests/tools/bench/accuracy/results.h"

namespace sgraphs::bench {
namespace {

TEST(SpreadTest, MedianOfAnOddCountIsTheValueInTheMiddle) {
  const auto spread = spreadOf({5, 1, 3});
  ASSERT_TRUE(spread);
  EXPECT_EQ(spread->count, 3u);
  EXPECT_DOUBLE_EQ(spread->median, 3);
  EXPECT_DOUBLE_EQ(spread->min, 1);
  EXPECT_DOUBLE_EQ(spread->max, 5);
}

TEST(SpreadTest, MedianOfAnEvenCountIsTheMeanOfTheTwoInTheMiddle) {
  EXPECT_DOUBLE_EQ(spreadOf({4, 1, 2, 10})->median, 3);
}

TEST(SpreadTest, OfNothingIsNothing) {
  EXPECT_FALSE(spreadOf({}));
}

TEST(SpreadTest, TakesOnlyRunsOfTheSceneAndIdThatHaveTheFigure) {
  const std::vector<RunResult> results{
      resultOf("a", 1, "lidar-walls", {{"ate_m", 1}}), resultOf("a", 2, "lidar-walls", {{"ate_m", 3}}),
      resultOf("a", 3, "lidar-walls", {{"map_rmse_m", 50}}), resultOf("b", 1, "lidar-walls", {{"ate_m", 70}}),
      resultOf("a", 1, "lidar-gicp", {{"ate_m", 90}})};
  const auto spread = spreadOf(results, "a", "lidar-walls", "ate_m");
  ASSERT_TRUE(spread);
  EXPECT_EQ(spread->count, 2u);
  EXPECT_DOUBLE_EQ(spread->median, 2);
}

}  // namespace
}  // namespace sgraphs::bench
