#include "perception/free_space/clusters/segmentation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "tests/perception/free_space/clusters/clusters_truth.h"
#include "tools/simulate/scene/test_worlds.h"

namespace sgraphs {
namespace {

// A building drawn by hand: walls 0.1 m thick along centre lines.
struct Drawing {
  simulate::Scene scene;

  void wall(double ax, double ay, double bx, double by) {
    simulate::Wall wall;
    wall.a = {ax, ay};
    wall.b = {bx, by};
    scene.walls.push_back(wall);
  }
  void walls(const std::vector<Eigen::Vector2d>& ring) {
    for (size_t i = 0; i < ring.size(); ++i) {
      const Eigen::Vector2d &a = ring[i], &b = ring[(i + 1) % ring.size()];
      wall(a.x(), a.y(), b.x(), b.y());
    }
  }
  void door(double x, double y, double width_m) {
    simulate::Doorway door;
    door.xyz = {x, y, 0};
    door.width_m = width_m;
    scene.doorways.push_back(door);
  }
  void room(const std::string& id, const std::vector<Eigen::Vector2d>& polygon) {
    simulate::Room room;
    room.id = id;
    room.polygon = polygon;
    scene.rooms.push_back(room);
  }
  void rectangle(const std::string& id, double x0, double y0, double x1, double y1) {
    walls({{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}});
    room(id, {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}});
  }
};

constexpr double kYaws_deg[] = {0, 17, 30, 45};

std::string listed(const Segmentation& found) {
  std::ostringstream text;
  for (const RegionPassage& passage : found.passages)
    text << passage.a << "-" << passage.b << " (" << passage.cut.left.transpose() << ") to ("
         << passage.cut.right.transpose() << ") " << passage.cut.width() << " m\n";
  return text.str();
}

// Every room one region, every door one passage and no more, at any heading and with any noise.
void expectAsDrawn(const Drawing& drawing, size_t turns = 0) {
  for (const double yaw_deg : kYaws_deg)
    for (const uint32_t seed : {1U, 2U}) {
      PlanView view;
      view.yaw_rad = yaw_deg * M_PI / 180;
      view.seed = seed;
      const PlanGrids grids = planGrids(drawing.scene, view);
      const Segmentation found = segment(grids.rooms, FreeSpaceGraphConfig{}, {});
      SCOPED_TRACE(testing::Message() << "turned by " << yaw_deg << " seed " << seed);
      EXPECT_EQ(found.regions.count, static_cast<int32_t>(drawing.scene.rooms.size()));
      // Walls take their half thickness from the drawn polygons.
      for (const RoomScore& score : scoreRooms(drawing.scene, view, grids.rooms, found))
        EXPECT_GE(score.iou, 0.7) << score.id;
      for (const DoorScore& score : scoreDoors(drawing.scene, view, found)) {
        EXPECT_LE(score.distance_m, 0.3) << score.place_building.transpose();
        EXPECT_LE(std::abs(score.width_error_m), 0.25) << score.place_building.transpose();
      }
      EXPECT_EQ(found.passages.size(), drawing.scene.doorways.size() + turns) << listed(found);
    }
}

TEST(SegmentationTest, ADoorOf80CmLeadsIntoAClosetOf120Cm) {
  Drawing drawing;
  drawing.rectangle("R1", 0, 0, 5, 4);
  drawing.rectangle("R2", 5, 1, 6.3, 2.4);
  drawing.door(5, 1.7, 0.8);
  expectAsDrawn(drawing);
}

TEST(SegmentationTest, AnOpeningOf220CmPartsTwoRooms) {
  Drawing drawing;
  drawing.rectangle("R1", 0, 0, 5, 6);
  drawing.rectangle("R2", 5, 0, 9.5, 6);
  drawing.door(5, 3, 2.2);
  expectAsDrawn(drawing);
}

TEST(SegmentationTest, ARoomShallowerThanItsOpeningIsWideIsARoom) {
  Drawing drawing;
  drawing.rectangle("R1", 0, 0, 6, 5);
  drawing.rectangle("R2", 0, 5, 4.4, 7.2);
  drawing.door(2.2, 5, 2.4);
  expectAsDrawn(drawing);
}

TEST(SegmentationTest, ACorridorWithManyDoorsIsNotCut) {
  Drawing drawing;
  drawing.rectangle("C_1", 0, 0, 24, 2);
  for (int k = 0; k < 6; ++k) {
    drawing.rectangle("N", 4.0 * k, 2, 4.0 * k + 4, 6);
    drawing.door(4.0 * k + 2, 2, 0.9);
    drawing.rectangle("S", 4.0 * k, -4, 4.0 * k + 4, 0);
    drawing.door(4.0 * k + 2, 0, 0.9);
  }
  expectAsDrawn(drawing);
}

TEST(SegmentationTest, AnLShapedRoomIsNotCut) {
  Drawing drawing;
  const std::vector<Eigen::Vector2d> shape{{0, 0}, {8, 0}, {8, 3}, {3.5, 3}, {3.5, 8}, {0, 8}};
  drawing.walls(shape);
  drawing.room("R1", shape);
  expectAsDrawn(drawing);
}

TEST(SegmentationTest, AHexagonAndATrapezoidAreNotCut) {
  Drawing drawing;
  std::vector<Eigen::Vector2d> hexagon;
  hexagon.reserve(6);
  for (int k = 0; k < 6; ++k) hexagon.emplace_back(3 * std::cos(k * M_PI / 3), 3 * std::sin(k * M_PI / 3));
  drawing.walls(hexagon);
  drawing.room("R1", hexagon);
  const std::vector<Eigen::Vector2d> trapezoid{{6, 0}, {14, 0}, {14, 2}, {6, 5}};
  drawing.walls(trapezoid);
  drawing.room("R2", trapezoid);
  expectAsDrawn(drawing);
}

TEST(SegmentationTest, AnLShapedCorridorIsTwoStraightArms) {
  Drawing drawing;
  drawing.walls({{0, 0}, {14, 0}, {14, 2}, {2, 2}, {2, 10}, {0, 10}});
  drawing.room("C_1", {{0, 0}, {14, 0}, {14, 2}, {0, 2}});  // the longer arm keeps the corner
  drawing.room("C_2", {{0, 2}, {2, 2}, {2, 10}, {0, 10}});
  expectAsDrawn(drawing, 1);
}

TEST(SegmentationTest, ABranchIsCutFromTheCorridorThatRunsThrough) {
  Drawing drawing;
  drawing.walls({{0, 0}, {18, 0}, {18, 2}, {10, 2}, {10, 11}, {8, 11}, {8, 2}, {0, 2}});
  drawing.room("C_1", {{0, 0}, {18, 0}, {18, 2}, {0, 2}});
  drawing.room("C_2", {{8, 2}, {10, 2}, {10, 11}, {8, 11}});
  expectAsDrawn(drawing, 1);
}

TEST(SegmentationTest, ARingOfCorridorsIsFourStraightArms) {
  Drawing drawing;
  drawing.walls({{0, 0}, {20, 0}, {20, 16}, {0, 16}});
  drawing.walls({{2, 2}, {18, 2}, {18, 14}, {2, 14}});
  drawing.room("C_S", {{0, 0}, {20, 0}, {20, 2}, {0, 2}});
  drawing.room("C_N", {{0, 14}, {20, 14}, {20, 16}, {0, 16}});
  drawing.room("C_W", {{0, 2}, {2, 2}, {2, 14}, {0, 14}});
  drawing.room("C_E", {{18, 2}, {20, 2}, {20, 14}, {18, 14}});
  expectAsDrawn(drawing, 4);
}

TEST(SegmentationTest, ACorridorThatOpensFlushIntoARoomEndsThere) {
  Drawing drawing;
  drawing.walls({{0, 0}, {6, 0}, {6, 2}, {16, 2}, {16, 3.8}, {6, 3.8}, {6, 6}, {0, 6}});
  drawing.room("R1", {{0, 0}, {6, 0}, {6, 6}, {0, 6}});
  drawing.room("C_1", {{6, 2}, {16, 2}, {16, 3.8}, {6, 3.8}});
  expectAsDrawn(drawing, 1);
}

TEST(SegmentationTest, ShelvesThatStandFreeDoNotCutARoom) {
  Drawing drawing;
  drawing.rectangle("R1", 0, 0, 14, 8);
  drawing.walls({{6.5, 2}, {7.5, 2}, {7.5, 3.4}, {6.5, 3.4}});
  drawing.walls({{6.5, 5}, {7.5, 5}, {7.5, 6.4}, {6.5, 6.4}});
  for (const double yaw_deg : kYaws_deg) {
    PlanView view;
    view.yaw_rad = yaw_deg * M_PI / 180;
    const PlanGrids grids = planGrids(drawing.scene, view);
    const Segmentation found = segment(grids.rooms, FreeSpaceGraphConfig{}, {});
    const auto scores = scoreRooms(drawing.scene, view, grids.rooms, found);
    EXPECT_GE(scores[0].iou, 0.85) << "turned by " << yaw_deg;
  }
}

// Two rooms of 4 x 4 m with an opening of so many cells between them.
StoreyGrid roomsWithOpening(int cells) {
  std::vector<std::string> rows(42, '#' + std::string(40, '.') + '#' + std::string(40, '.') + '#');
  rows.front() = rows.back() = std::string(83, '#');
  for (int k = 0; k < cells; ++k) rows[static_cast<size_t>(21 - cells / 2 + k)][41] = '.';
  return gridOf(rows);
}

TEST(SegmentationTest, WhatWasCutStaysCutUntilItIsClearlyWide) {
  const FreeSpaceGraphConfig config;
  std::vector<Cut> former;
  const auto regionsAt = [&](int cells) {
    const Segmentation found = segment(roomsWithOpening(cells), config, former);
    former.clear();
    for (const RegionPassage& passage : found.passages) former.push_back(passage.cut);
    return found.regions.count;
  };
  EXPECT_EQ(regionsAt(33), 1);  // 0.83 of the rooms' width
  EXPECT_EQ(regionsAt(28), 2);
  EXPECT_EQ(regionsAt(33), 2);
  EXPECT_EQ(regionsAt(36), 1);
  EXPECT_EQ(regionsAt(33), 1);
}

TEST(SegmentationTest, TheInsideOfAClosedBoxIsNoRegion) {
  std::vector<std::string> rows(50, '#' + std::string(60, '.') + '#');
  rows.front() = rows.back() = std::string(62, '#');
  for (size_t k = 0; k < 14; ++k) rows[20 + k].replace(20, 14, "#............#");
  rows[20].replace(20, 14, std::string(14, '#'));
  rows[33].replace(20, 14, std::string(14, '#'));
  EXPECT_EQ(segment(gridOf(rows), FreeSpaceGraphConfig{}, {}).regions.count, 1);
}

TEST(SegmentationTest, NothingKnownHasNoRegions) {
  StoreyGrid grid = gridOf({"    ", "    "}, 5);
  const Segmentation found = segment(grid, FreeSpaceGraphConfig{}, {});
  EXPECT_EQ(found.regions.count, 0);
  EXPECT_TRUE(found.passages.empty());
}

}  // namespace
}  // namespace sgraphs
