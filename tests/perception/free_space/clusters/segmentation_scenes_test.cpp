#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "tests/perception/free_space/clusters/clusters_truth.h"

namespace sgraphs {
namespace {

struct Case {
  const char* scene;
  int floor;
  double yaw_deg;
};

void PrintTo(const Case& c, std::ostream* out) {
  *out << c.scene << " floor " << c.floor << " turned by " << c.yaw_deg << " degrees";
}

class SegmentationScenes : public testing::TestWithParam<Case> {
 protected:
  void SetUp() override {
    scene_ = shippedScene(GetParam().scene);
    view_.floor = GetParam().floor;
    view_.yaw_rad = GetParam().yaw_deg * M_PI / 180;
    const PlanGrids grids = planGrids(scene_, view_);
    grid_ = grids.rooms;
    found_ = segment(grid_, FreeSpaceGraphConfig{}, {});
  }

  simulate::Scene scene_;
  PlanView view_;
  StoreyGrid grid_;
  Segmentation found_;
};

TEST_P(SegmentationScenes, EachRoomIsOneClusterAndNoneIsCut) {
  std::set<int32_t> regions;
  double mean_iou = 0;
  const auto scores = scoreRooms(scene_, view_, grid_, found_);
  for (const RoomScore& score : scores) {
    EXPECT_GE(score.iou, 0.85) << score.id;
    EXPECT_TRUE(regions.insert(score.region).second) << score.id << " shares a cluster";
    mean_iou += score.iou / static_cast<double>(scores.size());
  }
  EXPECT_GE(mean_iou, 0.9);
  EXPECT_LE(found_.regions.count, static_cast<int32_t>(scores.size()) + 1);
}

TEST_P(SegmentationScenes, EachDoorwayIsAPassageAtItsPlaceAndWidth) {
  double squared_m2 = 0;
  const auto scores = scoreDoors(scene_, view_, found_);
  for (const DoorScore& score : scores) {
    EXPECT_LE(score.distance_m, 0.3) << score.place_building.transpose();
    EXPECT_LE(std::abs(score.width_error_m), 0.25) << score.place_building.transpose();
    squared_m2 += score.width_error_m * score.width_error_m / static_cast<double>(scores.size());
  }
  // Where all faces lie on borders of cells, all are off by half a cell, to the same side.
  EXPECT_LE(std::sqrt(squared_m2), GetParam().yaw_deg == 0 ? 0.22 : 0.13);
}

std::vector<Case> cases() {
  std::vector<Case> list;
  for (const double yaw_deg : {0.0, 30.0, 45.0}) {
    for (const char* scene : {"cf1", "cf2", "se1", "se2", "lc1", "offices20", "turned", "small_office"})
      list.push_back({scene, 0, yaw_deg});
    list.push_back({"two_rooms", 0, yaw_deg});
    list.push_back({"two_storeys", 0, yaw_deg});
    list.push_back({"two_storeys", 1, yaw_deg});
  }
  list.push_back({"hall", 0, 0.0});
  return list;
}

INSTANTIATE_TEST_SUITE_P(Shipped, SegmentationScenes, testing::ValuesIn(cases()));

// A flush opening of an arm as wide as the opening itself: either side of it may own the arm.
TEST(SegmentationScenesTest, TurtlebotHouseHasItsSixRooms) {
  const simulate::Scene scene = shippedScene("turtlebot3_house");
  for (const double yaw_deg : {0.0, 30.0, 45.0}) {
    PlanView view;
    view.yaw_rad = yaw_deg * M_PI / 180;
    const PlanGrids grids = planGrids(scene, view);
    const Segmentation found = segment(grids.rooms, FreeSpaceGraphConfig{}, {});
    for (const RoomScore& score : scoreRooms(scene, view, grids.rooms, found)) {
      if (score.id == "C_1") continue;  // two metres of hallway: a cluster of its own, or part of a neighbour
      EXPECT_GE(score.iou, 0.75) << score.id << " at " << yaw_deg;
    }
  }
}

}  // namespace
}  // namespace sgraphs
