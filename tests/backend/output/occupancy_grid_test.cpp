#include "backend/output/occupancy_grid.h"

#include <gmock/gmock.h>

#include "tests/backend/output/synthetic_run.h"

namespace sgraphs {
namespace {

using test::kFloor;

// Share of the cells along a segment that hold `value`.
double share(const OccupancyGrid& grid, const Eigen::Vector2d& a, const Eigen::Vector2d& b, Occupancy value) {
  int hits = 0;
  for (int i = 0; i <= 100; ++i) hits += grid.at(a + (b - a) * i / 100.0) == value;
  return hits / 101.0;
}

TEST(OccupancyGridTest, WallsAreOccupiedTheRoomIsFreeTheRestUnknown) {
  const auto run = test::makeSyntheticRun();
  const OccupancyGrid grid = buildOccupancy(run->graph, kFloor, 0.05);
  const auto& [low, high] = run->room;
  const double e = 1e-3;  // the wall's cell may lie on either side of the plane
  for (const double y : {low.y(), high.y()})
    EXPECT_GT(share(grid, {low.x() + 0.1, y + e}, {high.x() - 0.1, y + e}, Occupancy::kOccupied) +
                  share(grid, {low.x() + 0.1, y - e}, {high.x() - 0.1, y - e}, Occupancy::kOccupied),
              0.9);
  EXPECT_EQ(share(grid, {low.x() + 0.1, 2}, {high.x() - 0.1, 2}, Occupancy::kFree), 1);
  EXPECT_EQ(share(grid, {3, low.y() + 0.1}, {3, high.y() - 0.1}, Occupancy::kFree), 1);
  EXPECT_EQ(grid.at({high.x() + 0.2, 2}), Occupancy::kUnknown);
  EXPECT_EQ(grid.at({100, 100}), Occupancy::kUnknown);
}

TEST(OccupancyGridTest, FloorAndCeilingDoNotOccupy) {
  const auto run = test::makeSyntheticRun();
  const OccupancyGrid grid = buildOccupancy(run->graph, kFloor, 0.05);
  for (double x = 0; x < 6; x += 0.05) EXPECT_NE(grid.at({x, 2.5}), Occupancy::kOccupied) << x;
}

TEST(OccupancyGridTest, WhoWalkedByIsCleared) {
  const auto run = test::makeSyntheticRun();
  // One keyframe saw someone in the middle of the room.
  auto seen = std::make_shared<Keyframe>(*run->graph.keyframes.at({0}).keyframe);
  seen->points.push_back({{2.025f, 1.525f, 0.5f}, 0, 5});
  run->graph.keyframes.at({0}).keyframe = seen;
  EXPECT_EQ(buildOccupancy(run->graph, kFloor, 0.05).at({2.025, 1.525}), Occupancy::kFree);
}

TEST(OccupancyGridTest, MapServerFormat) {
  OccupancyGrid grid{{-1, 2}, 0.5, 2, 2, {}};
  grid.cells = {Occupancy::kFree, Occupancy::kOccupied, Occupancy::kUnknown, Occupancy::kFree};
  const std::string pgm = occupancyPgm(grid);
  const std::string header = "P5\n2 2\n255\n";
  ASSERT_EQ(pgm.substr(0, header.size()), header);
  // The first row of the image is the one of largest y.
  EXPECT_EQ(pgm.substr(header.size()), std::string("\xCD\xFE\xFE\x00", 4));
  const std::string yaml = occupancyYaml(grid, "a.pgm");
  EXPECT_THAT(yaml, testing::HasSubstr("image: a.pgm\n"));
  EXPECT_THAT(yaml, testing::HasSubstr("resolution: 0.500000\norigin: [-1.000000, 2.000000, 0.0]\n"));
}

}  // namespace
}  // namespace sgraphs
