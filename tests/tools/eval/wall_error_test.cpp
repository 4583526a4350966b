#include "tools/eval/wall_error.h"

#include <gmock/gmock.h>

#include <Eigen/Geometry>

#include "tests/tools/eval/truth_fixture.h"
#include "tests/tools/eval/two_rooms.h"

namespace sgraphs {
namespace {

using test::TwoRooms;

// Walls are given in the building's frame; the judge gets them in a map that lies anywhere.
struct Judge {
  TwoRooms rooms;
  MeshQuery mesh{rooms.mesh};
  std::vector<TrueFace> faces = trueFaces(rooms.plan, mesh);
  std::vector<EstimatedWall> walls;

  // Every face that is asked for, once.
  void mapAll() {
    for (const size_t f : {TwoRooms::kSouth, TwoRooms::kNorth, TwoRooms::kWest, TwoRooms::kPartitionWest})
      walls.push_back(TwoRooms::wholeOf(faces[f]));
  }
  WallResult judge(double duration_s = 10) const {
    std::vector<EstimatedWall> in_map;
    for (const EstimatedWall& wall : walls) in_map.push_back(moved(wall, test::kSomeTransform));
    return judgeWalls(rooms.plan, mesh, TwoRooms::standing(duration_s, {2, 0.4, 0.5}), in_map,
                      test::kSomeTransform.inverse());
  }
};

TEST(WallErrorTest, APerfectMapFindsEveryFaceOnce) {
  Judge j;
  j.mapAll();
  const WallResult result = j.judge();
  EXPECT_EQ(result.counts(true).faces, 4u);
  EXPECT_EQ(result.counts(true).found, 4u);
  EXPECT_EQ(result.counts(true).missed, 0u);
  EXPECT_EQ(result.counts(true).doubled, 0u);
  EXPECT_EQ(result.counts(false).faces, 6u);
  EXPECT_EQ(result.counts(false).found, 0u);
  EXPECT_TRUE(result.false_walls.empty());
  EXPECT_EQ(result.matches.size(), 4u);
  EXPECT_LT(result.angle_rad.max, 1e-6);
  EXPECT_LT(result.offset_m.max, 1e-9);
}

TEST(WallErrorTest, FacesSeenForLessThanFiveSecondsAreNotAskedFor) {
  Judge j;
  j.mapAll();
  const WallResult result = j.judge(4);
  EXPECT_EQ(result.counts(true).faces, 0u);
  EXPECT_EQ(result.counts(false).found, 4u);
}

TEST(WallErrorTest, AFaceWithoutAnEstimateIsMissed) {
  Judge j;
  j.mapAll();
  j.walls.erase(j.walls.begin() + 1);
  const WallResult result = j.judge();
  EXPECT_EQ(result.counts(true).missed, 1u);
  EXPECT_FALSE(result.found[TwoRooms::kNorth]);
}

TEST(WallErrorTest, ErrorsAreTheEstimatesAngleAndOffset) {
  Judge j;
  j.mapAll();
  j.walls[0] = test::shifted(j.walls[0], 0.02);
  j.walls[1] = test::turned(j.walls[1], 0.01);
  const WallResult result = j.judge();
  EXPECT_EQ(result.counts(true).found, 4u);
  EXPECT_NEAR(result.offset_m.max, 0.02, 1e-9);
  EXPECT_NEAR(result.offset_m.median, 0, 1e-9);
  EXPECT_NEAR(result.angle_rad.max, 0.01, 1e-6);
}

TEST(WallErrorTest, TooFarTooTurnedOrFromBehindIsNotFound) {
  const Judge j;
  const EstimatedWall south = TwoRooms::wholeOf(j.faces[TwoRooms::kSouth]);
  EstimatedWall behind = south;
  behind.normal = -behind.normal;
  for (const EstimatedWall& wall :
       {test::shifted(south, 0.06), test::turned(south, 6 * M_PI / 180), behind}) {
    Judge one;
    one.walls = {wall};
    EXPECT_FALSE(one.judge().found[TwoRooms::kSouth]);
  }
  Judge within;
  within.walls = {test::shifted(south, 0.04), test::turned(south, -4 * M_PI / 180)};
  EXPECT_EQ(within.judge().matches.size(), 2u);
}

TEST(WallErrorTest, AnEstimateBesideTheFacesEndsIsNotOnIt) {
  Judge j;
  j.walls = {TwoRooms::estimateOf(j.faces[TwoRooms::kSouth], 9, 11)};
  EXPECT_FALSE(j.judge().found[TwoRooms::kSouth]);
}

TEST(WallErrorTest, OneEstimateMayCoverTwoFacesInOneLine) {
  Judge j;
  j.rooms.plan.walls[0].b.x() = 4;
  j.rooms.plan.walls.push_back({{4, 0}, {8, 0}, 0.1, 0, 2.5});
  j.walls = {TwoRooms::wholeOf(j.faces[TwoRooms::kSouth])};
  const WallResult result = j.judge();
  EXPECT_TRUE(result.found[TwoRooms::kSouth]);
  EXPECT_TRUE(result.found[10]);
  EXPECT_EQ(result.counts(true).doubled, 0u);
}

size_t doubledBy(const EstimatedWall& a, const EstimatedWall& b) {
  Judge j;
  j.walls = {a, b};
  return j.judge().counts(true).doubled;
}

TEST(WallErrorTest, TwoEstimatesOfOneStretchAreADouble) {
  const Judge j;
  const TrueFace& south = j.faces[TwoRooms::kSouth];
  const EstimatedWall whole = TwoRooms::wholeOf(south);
  EXPECT_EQ(doubledBy(whole, test::shifted(whole, 0.03)), 1u);
  EXPECT_EQ(doubledBy(whole, TwoRooms::estimateOf(south, 2, 3)), 1u);
  EXPECT_EQ(doubledBy(TwoRooms::estimateOf(south, 0, 4), TwoRooms::estimateOf(south, 1.6, 5.6)), 1u);
}

TEST(WallErrorTest, PiecesBesideOrAboveEachOtherAreNoDouble) {
  const Judge j;
  const TrueFace& south = j.faces[TwoRooms::kSouth];
  EXPECT_EQ(doubledBy(TwoRooms::estimateOf(south, 0, 4), TwoRooms::estimateOf(south, 4, 8)), 0u);
  EXPECT_EQ(doubledBy(TwoRooms::estimateOf(south, 0, 4), TwoRooms::estimateOf(south, 2.8, 6.8)), 0u);
  EXPECT_EQ(doubledBy(TwoRooms::estimateOf(south, 0, 8, 0, 1.2), TwoRooms::estimateOf(south, 0, 8, 1.4, 2.4)),
            0u);
}

TEST(WallErrorTest, TheTwoFacesOfAWallAreNoDouble) {
  Judge j;
  j.mapAll();
  j.walls.push_back(TwoRooms::wholeOf(j.faces[TwoRooms::kPartitionEast]));
  const WallResult result = j.judge();
  EXPECT_EQ(result.counts(true).doubled, 0u);
  EXPECT_TRUE(result.found[TwoRooms::kPartitionEast]);
  EXPECT_EQ(result.counts(false).found, 1u);
}

TEST(WallErrorTest, FalseWallsLieOnNoSurface) {
  const Judge j;
  const EstimatedWall south = TwoRooms::estimateOf(j.faces[TwoRooms::kSouth], 1, 3);
  const EstimatedWall in_the_air = test::shifted(south, 1.0);
  const EstimatedWall on_the_cupboard =
      test::shifted(TwoRooms::estimateOf(j.faces[TwoRooms::kWest], 0.2, 1.0, 0.1, 1.7), 0.65);
  const EstimatedWall small = test::shifted(TwoRooms::estimateOf(j.faces[TwoRooms::kSouth], 1, 1.3, 0, 1), 1);
  EstimatedWall level = in_the_air;
  level.label = "horizontal";
  Judge judge;
  judge.walls = {south, in_the_air, on_the_cupboard, small, level};
  const WallResult result = judge.judge();
  EXPECT_THAT(result.false_walls, testing::ElementsAre(1));
  EXPECT_EQ(result.walls.size(), 4u);
}

TEST(WallErrorTest, AreaOfAPolygonInSpace) {
  std::vector<Eigen::Vector3d> corners;
  for (const Eigen::Vector3d& p :
       {Eigen::Vector3d(0, 0, 0), {2, 0, 0}, {2, 0, 1}, {1, 0, 1}, {1, 0, 2}, {0, 0, 2}})
    corners.push_back(test::kSomeTransform * p);
  EXPECT_NEAR(polygonArea(corners), 3, 1e-9);
}

// The partition is of glass, whether the mesh holds the pane or not.
TEST(WallErrorTest, PanesAreNeitherAskedForNorFalse) {
  Judge j;
  j.rooms.plan.walls[4].glass = true;
  j.faces = trueFaces(j.rooms.plan, j.mesh);
  j.mapAll();
  EXPECT_EQ(j.judge().counts(true).faces, 3u);
  EXPECT_TRUE(j.judge().found[TwoRooms::kPartitionWest]);
  j.rooms.mesh = test::rectangle({0, 0, 0}, {8, 0, 0}, {0, 4, 0});  // a floor and nothing on it
  const WallResult result = judgeWalls(
      j.rooms.plan, MeshQuery(j.rooms.mesh), TwoRooms::standing(10),
      {TwoRooms::wholeOf(j.faces[TwoRooms::kPartitionWest]), TwoRooms::wholeOf(j.faces[TwoRooms::kSouth])},
      SE3{});
  EXPECT_EQ(result.false_walls, std::vector<size_t>{1});
}

TEST(WallErrorTest, AWallOnThePaneOfAWindowIsNotFalse) {
  Judge j;
  const EstimatedWall pane =
      test::shifted(TwoRooms::estimateOf(j.faces[TwoRooms::kSouth], 1, 2.5, 0.8, 1.9), 1.0);
  j.walls = {pane};
  EXPECT_EQ(j.judge().false_walls.size(), 1u);
  const Eigen::Vector2d a = pane.polygon[0].head<2>(), b = pane.polygon[1].head<2>();
  j.rooms.plan.panes = {{a, b, 0, 0.8, 1.9, true}};
  EXPECT_TRUE(j.judge().false_walls.empty());
  j.rooms.plan.panes.front().z_high_m = 1.2;
  EXPECT_EQ(j.judge().false_walls.size(), 1u);
}

}  // namespace
}  // namespace sgraphs
