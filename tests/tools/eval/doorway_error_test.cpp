#include "tools/eval/doorway_error.h"

#include <gmock/gmock.h>

#include "tests/tools/eval/house.h"

namespace sgraphs {
namespace {

using test::House;
using test::kMapOfHouse;

struct DoorwayErrorTest : testing::Test {
  House house;
  EstimatedGraph graph = house.graph(kMapOfHouse);
  DoorwayResult judge() const { return judgeDoorways(house.plan, house.poses, graph, kMapOfHouse.inverse()); }
  void shift(size_t doorway, const Eigen::Vector3d& by_truth) {
    graph.doorways[doorway].position += kMapOfHouse.rotation * by_truth;
  }
};

TEST_F(DoorwayErrorTest, TrueDoorwaysAreFound) {
  const DoorwayResult result = judge();
  EXPECT_EQ(result.walked_through.asked, 3u);
  EXPECT_EQ(result.walked_through.found, 3u);
  EXPECT_EQ(result.of_asked_rooms.asked, 4u);  // not that of R4
  EXPECT_EQ(result.of_asked_rooms.found, 4u);
  EXPECT_EQ(result.all.found, 5u);
  EXPECT_EQ(result.num_false, 0u);
  EXPECT_NEAR(result.distance_m.max, 0, 1e-9);
}

TEST_F(DoorwayErrorTest, HalfAMetreSeenFromAboveIsTheLimit) {
  shift(0, {0.3, 0.39, 0.8});
  shift(2, {0.3, 0.41, 0});
  graph.doorways[0].width_m -= 0.12;
  const DoorwayResult result = judge();
  EXPECT_TRUE(result.truth[0].estimate);
  EXPECT_NEAR(result.truth[0].distance_m, std::hypot(0.3, 0.39), 1e-9);
  EXPECT_NEAR(result.truth[0].width_error_m, -0.12, 1e-9);
  EXPECT_FALSE(result.truth[2].estimate);
  EXPECT_EQ(result.walked_through.found, 2u);
  EXPECT_EQ(result.num_false, 1u);
  EXPECT_NEAR(result.width_error_m.max, 0.12, 1e-9);
}

TEST_F(DoorwayErrorTest, OneToOneNearestFirst) {
  graph.doorways.push_back(graph.doorways[0]);
  shift(0, {0, 0.2, 0});
  const DoorwayResult result = judge();
  EXPECT_EQ(*result.truth[0].estimate, 5u);
  EXPECT_FALSE(result.estimates[0].is_true);
  EXPECT_EQ(result.num_false, 1u);
}

// Doorways 1 and 3 stand above each other.
TEST_F(DoorwayErrorTest, DoorwaysAreOnTheirStorey) {
  graph.doorways = {graph.doorways[3]};
  EXPECT_FALSE(judge().truth[1].estimate);
  EXPECT_TRUE(judge().truth[3].estimate);
  // Without a floor that says where it is, its own height counts.
  graph.floors[1].z_m.reset();
  EXPECT_TRUE(judge().truth[3].estimate);
  shift(0, {0, 0, 0.5 - House::kUpper_m});
  EXPECT_TRUE(judge().truth[1].estimate);
}

}  // namespace
}  // namespace sgraphs
