#include <gmock/gmock.h>

#include <opencv2/imgcodecs.hpp>

#include "backend/output/floor_plan.h"
#include "tests/backend/output/synthetic_planes.h"

namespace sgraphs {
namespace {

using test::kFloor;
using test::kFloorZ_m;

PlaneNode wallAt(int64_t id, double y_m, double half_height_m = 1.4) {
  return test::rectanglePlane({id}, PlaneLabel::kY, Eigen::Vector3d::UnitY(),
                              {2, y_m, kFloorZ_m + half_height_m}, 3, half_height_m);
}

TEST(FloorPlanWallsTest, AWallIsALineWhoseLeftSideItFaces) {
  SituationalGraph graph;
  graph.planes[{7}] = wallAt(7, 1.5);
  const auto lines = wallLines(graph, kFloor);
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_EQ(lines[0].wall, PlaneId{7});
  EXPECT_NEAR((lines[0].a - Eigen::Vector2d(-1, 1.5)).norm(), 0, 1e-9);
  EXPECT_NEAR((lines[0].b - Eigen::Vector2d(5, 1.5)).norm(), 0, 1e-9);
}

TEST(FloorPlanWallsTest, ADoorwayInTheExtentLeavesAGap) {
  SituationalGraph graph;
  PlaneNode wall = wallAt(0, 0);
  // From 1 m to 2 m along x the wall begins only 2.1 m over the floor.
  wall.polygon_map.clear();
  for (const auto& [x, h] :
       {std::pair(-1.0, 0.0), std::pair(-1.0, 2.8), std::pair(5.0, 2.8), std::pair(5.0, 0.0),
        std::pair(2.0, 0.0), std::pair(2.0, 2.1), std::pair(1.0, 2.1), std::pair(1.0, 0.0)})
    wall.polygon_map.emplace_back(x, 0, kFloorZ_m + h);
  graph.planes[{0}] = wall;
  const auto lines = wallLines(graph, kFloor);
  ASSERT_EQ(lines.size(), 2u);
  EXPECT_NEAR(lines[0].b.x(), 1, 1e-9);
  EXPECT_NEAR(lines[1].a.x(), 2, 1e-9);
  EXPECT_NEAR(lines[1].b.x(), 5, 1e-9);
}

TEST(FloorPlanWallsTest, LevelPlanesOtherStoreysAndLintelsAreNoWalls) {
  SituationalGraph graph;
  graph.planes[{0}] =
      test::rectanglePlane({0}, PlaneLabel::kHorizontal, Eigen::Vector3d::UnitZ(), {0, 0, 0}, 3, 3);
  graph.planes[{1}] = wallAt(1, 0);
  graph.planes[{1}].floor = {1};
  graph.planes[{2}] = wallAt(2, 0, 0.3);
  for (auto& corner : graph.planes[{2}].polygon_map) corner.z() += 2.2;
  EXPECT_TRUE(wallLines(graph, kFloor).empty());
  graph.planes[{3}] = wallAt(3, 0);
  graph.planes[{3}].floor = {};  // no storeys were told apart
  EXPECT_EQ(wallLines(graph, kFloor).size(), 1u);
}

// Dark runs along a column of the picture that crosses the walls away from path and ink.
int darkRuns(const cv::Mat& image, int col, int row_begin, int row_end) {
  int runs = 0;
  bool dark = false;
  for (int row = row_begin; row < row_end; ++row) {
    const auto& pixel = image.at<cv::Vec3b>(row, col);
    const bool now = std::max({pixel[0], pixel[1], pixel[2]}) < 110;
    runs += now && !dark;
    dark = now;
  }
  return runs;
}

TEST(FloorPlanWallsTest, AWallThatWasMappedTwiceIsTwoLines) {
  const auto run = test::makeSyntheticRun();
  run->graph.planes[{0}] = wallAt(0, 1.3);
  const auto picture = [&] {
    const std::string png = floorPlanPng(makeFloorPlan(run->graph, kFloor, {}, run->record.scans));
    return cv::imdecode(std::vector<uchar>(png.begin(), png.end()), cv::IMREAD_COLOR);
  };
  const cv::Mat once = picture();
  run->graph.planes[{1}] = wallAt(1, 1.4);
  const cv::Mat twice = picture();
  ASSERT_EQ(once.cols, twice.cols);
  // The picture's middle is the square path's middle, x = 2 m, where only the walls are.
  const int middle = once.cols / 2;
  EXPECT_EQ(darkRuns(once, middle, once.rows * 2 / 5, once.rows * 3 / 5), 1);
  EXPECT_EQ(darkRuns(twice, middle, once.rows * 2 / 5, once.rows * 3 / 5), 2);
}

}  // namespace
}  // namespace sgraphs
