#include "backend/output/floor_plan.h"

#include <gmock/gmock.h>

#include <opencv2/imgcodecs.hpp>

#include "tests/backend/output/synthetic_run.h"

namespace sgraphs {
namespace {

using test::kFloor;

FloorPlan planOf(const test::SyntheticRun& run) {
  return makeFloorPlan(run.graph, kFloor, buildMap(run.graph, 0.05), run.record.scans);
}

bool hasInk(const FloorPlan& plan, double x, double y) {
  for (int dx = -1; dx <= 1; ++dx)
    for (int dy = -1; dy <= 1; ++dy) {
      const int col = static_cast<int>(std::floor((x - plan.ink.origin.x()) / plan.ink.cell)) + dx;
      const int row = static_cast<int>(std::floor((y - plan.ink.origin.y()) / plan.ink.cell)) + dy;
      if (plan.ink.indices.at(static_cast<size_t>(row) * plan.ink.width + col)) return true;
    }
  return false;
}

TEST(FloorPlanTest, InkLiesAlongTheWallsOnly) {
  const auto run = test::makeSyntheticRun();
  const FloorPlan plan = planOf(*run);
  const auto& [low, high] = run->room;
  int walls = 0, samples = 0;
  for (double x = low.x() + 0.1; x < high.x(); x += 0.1, samples += 2)
    walls += hasInk(plan, x, low.y()) + hasInk(plan, x, high.y());
  EXPECT_GT(walls, 0.95 * samples);
  for (double x = low.x() + 0.3; x < high.x() - 0.2; x += 0.1)
    for (double y = low.y() + 0.3; y < high.y() - 0.2; y += 0.1)
      ASSERT_FALSE(hasInk(plan, x, y)) << x << " " << y;
}

TEST(FloorPlanTest, PathIsTheTrajectoryInMap) {
  const auto run = test::makeSyntheticRun();
  const FloorPlan plan = planOf(*run);
  EXPECT_EQ(plan.path.size(), run->record.scans.size());
  EXPECT_LT((plan.path[50].position_map - test::squarePath(5.0).translation.head<2>()).norm(), 1e-9);
  EXPECT_NEAR(plan.path.back().time_s, 13.9, 1e-9);
}

TEST(FloorPlanTest, FarReturnsThroughAWindowDoNotShrinkThePicture) {
  const auto run = test::makeSyntheticRun();
  auto map = buildMap(run->graph, 0.05);
  map.push_back({{500, 0, 0.5f}, {0}, 1});
  EXPECT_LT(makeFloorPlan(run->graph, kFloor, map, run->record.scans).extent.max.x(), 10);
}

TEST(FloorPlanTest, PngHasWhitePaperDarkWallsAndAColouredPath) {
  const auto run = test::makeSyntheticRun();
  const std::string png = floorPlanPng(planOf(*run));
  const cv::Mat image = cv::imdecode(std::vector<uchar>(png.begin(), png.end()), cv::IMREAD_COLOR);
  ASSERT_GT(image.cols, 600);
  int white = 0, dark = 0, coloured = 0;
  for (int row = 0; row < image.rows; ++row)
    for (int col = 0; col < image.cols; ++col) {
      const auto& pixel = image.at<cv::Vec3b>(row, col);
      const int low = std::min({pixel[0], pixel[1], pixel[2]}),
                high = std::max({pixel[0], pixel[1], pixel[2]});
      white += low > 250;
      dark += high < 100;
      coloured += high - low > 60;
    }
  EXPECT_EQ(image.at<cv::Vec3b>(0, 0), cv::Vec3b(255, 255, 255));
  EXPECT_GT(white, image.rows * image.cols / 2);
  EXPECT_GT(dark, 2000);
  EXPECT_GT(coloured, 2000);
}

TEST(FloorPlanTest, SvgIsInMillimetresOfTheBuilding) {
  const auto run = test::makeSyntheticRun();
  const std::string svg = floorPlanSvg(planOf(*run));
  EXPECT_THAT(svg, testing::StartsWith("<?xml"));
  EXPECT_THAT(svg, testing::HasSubstr("Floor f0"));
  EXPECT_THAT(svg, testing::HasSubstr("<polyline"));
  EXPECT_THAT(svg, testing::HasSubstr("h50v50h-50z"));  // one cell of 5 cm
  EXPECT_THAT(svg, testing::EndsWith("</svg>\n"));
}

}  // namespace
}  // namespace sgraphs
