#include "tools/eval/room_error.h"

#include <gmock/gmock.h>

#include "tests/tools/eval/house.h"

namespace sgraphs {
namespace {

using test::box;
using test::House;
using test::kMapOfHouse;
using testing::HasSubstr;

struct RoomErrorTest : testing::Test {
  House house;
  EstimatedGraph graph = house.graph(kMapOfHouse);

  RoomResult judge() const { return judgeRooms(house.plan, house.poses, graph, kMapOfHouse.inverse()); }
  void onlyRooms(const std::vector<std::pair<Corners, size_t>>& rooms) {
    graph.rooms.clear();
    for (const auto& [polygon, floor] : rooms) House::addRoom(graph, polygon, floor, kMapOfHouse);
  }
};

TEST_F(RoomErrorTest, TrueRoomsAreFound) {
  const RoomResult result = judge();
  EXPECT_EQ(result.num_asked, 3u);
  EXPECT_EQ(result.num_found, 3u);
  EXPECT_EQ(result.num_true, 4u);  // R4, which nobody entered, is true nevertheless
  EXPECT_EQ(result.num_false, 0u);
  EXPECT_NEAR(result.mean_iou, 1, 1e-9);
  EXPECT_NEAR(result.area_error_m2.max, 0, 1e-9);
  EXPECT_EQ(*result.truth[4].estimate, 4u);
}

TEST_F(RoomErrorTest, NotchFilledUpCostsItsArea) {
  onlyRooms({{box(4.2, 0, 8.2, 4), 0}});
  const RoomResult result = judge();
  EXPECT_EQ(result.num_found, 1u);
  EXPECT_NEAR(result.truth[1].iou, 12.0 / 16, 1e-9);
  EXPECT_NEAR(result.truth[1].area_error_m2, 4, 1e-9);
  EXPECT_EQ(result.num_asked - result.num_found, 2u);
}

TEST_F(RoomErrorTest, LessThanHalfIsMissedAndFalse) {
  onlyRooms({{box(0, 0, 4, 1.96), 0}, {box(0, 0, 4, 2.04), 1}});
  const RoomResult result = judge();
  EXPECT_FALSE(result.truth[0].estimate);
  EXPECT_EQ(result.estimates[0].why_false, "IoU 0.49 at best, with R1");
  EXPECT_EQ(*result.truth[4].estimate, 1u);
  EXPECT_EQ(result.num_false, 1u);
}

TEST_F(RoomErrorTest, OfTwoForOneTheBetterCounts) {
  onlyRooms({{box(0, 0, 4, 3), 0}, {box(0, 0, 4, 3.5), 0}});
  const RoomResult result = judge();
  EXPECT_EQ(*result.truth[0].estimate, 1u);
  EXPECT_EQ(result.estimates[0].why_false, "is R1 once more, after r1");
}

TEST_F(RoomErrorTest, OneOverTwoRoomsIsNoRoom) {
  onlyRooms({{box(0, 0, 8.2, 4), 0}});
  EXPECT_EQ(judge().num_found, 0u);
  EXPECT_EQ(judge().num_false, 1u);
}

TEST_F(RoomErrorTest, PiecesOfCorridorsAreNotFalse) {
  // The second lies in the corridor by 0.61, the third by 0.59.
  onlyRooms({{box(0, 4.2, 3, 6), 0}, {box(0, 4.9, 1, 6.7), 0}, {box(7, 4.94, 8, 6.74), 0}});
  const RoomResult result = judge();
  EXPECT_EQ(result.estimates[0].why_false, "");
  EXPECT_EQ(result.estimates[1].why_false, "");
  EXPECT_THAT(result.estimates[2].why_false, HasSubstr("with C_1"));
  EXPECT_EQ(result.num_true, 0u);
}

TEST_F(RoomErrorTest, RoomsOfAnotherStoreyDoNotCount) {
  onlyRooms({{box(0, 0, 4, 4), 1}, {box(0, 4.2, 8.2, 6), 1}});
  const RoomResult result = judge();
  EXPECT_FALSE(result.truth[0].estimate);
  EXPECT_TRUE(result.truth[4].estimate);
  EXPECT_EQ(result.estimates[1].why_false, "overlaps no true room of its floor");
}

TEST_F(RoomErrorTest, WithoutAHeightAFloorIsTheLowest) {
  onlyRooms({{box(0, 0, 4, 4), 1}});
  graph.floors.clear();
  EXPECT_TRUE(judge().truth[0].estimate);
}

TEST_F(RoomErrorTest, OutlinesThatAreNoneAreFalse) {
  onlyRooms({{{{0, 0}, {4, 4}, {4, 0}, {0, 4}}, 0}, {{{0, 0}, {4, 4}}, 0}, {{}, 0}});
  const RoomResult result = judge();
  EXPECT_EQ(result.estimates[0].why_false, "has an outline that crosses itself");
  EXPECT_EQ(result.estimates[1].why_false, "has less than three corners");
  EXPECT_EQ(result.num_false, 3u);
  EXPECT_EQ(result.num_found, 0u);
}

TEST_F(RoomErrorTest, TimeToDetectionRunsFromTheFirstSecondInside) {
  graph.rooms[0].accepted = House::kStart + Duration{5'500'000};
  graph.rooms[1].accepted = House::kStart + Duration{30'200'000};
  graph.rooms[4].accepted = House::kStart + Duration{1'000'000};
  const RoomResult result = judge();
  EXPECT_NEAR(*result.truth[0].detection_s, 5.5, 1e-9);
  EXPECT_NEAR(*result.truth[1].detection_s, 7, 0.05);
  EXPECT_EQ(*result.truth[4].detection_s, 0);  // before anybody was inside
  // Only R1 was occupied for 15 s.
  EXPECT_EQ(result.num_long_visits, 1u);
  EXPECT_EQ(result.detection_s->count, 1u);
  EXPECT_NEAR(result.detection_s->median, 5.5, 1e-9);
}

TEST_F(RoomErrorTest, NoTimeToDetectionWithoutStamps) {
  const RoomResult result = judge();
  EXPECT_FALSE(result.detection_s);
  EXPECT_EQ(result.num_long_visits, 1u);
}

}  // namespace
}  // namespace sgraphs
