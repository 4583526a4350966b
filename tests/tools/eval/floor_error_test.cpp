#include "tools/eval/floor_error.h"

#include <gmock/gmock.h>

#include "tests/tools/eval/house.h"

namespace sgraphs {
namespace {

using test::House;
using test::kMapOfHouse;

struct FloorErrorTest : testing::Test {
  House house;
  EstimatedGraph graph = house.graph(kMapOfHouse);
  FloorResult judge() const {
    return judgeFloors(house.plan, house.poses, graph.floors, kMapOfHouse.inverse());
  }
};

TEST_F(FloorErrorTest, HeightsAreComparedAfterTheAlignment) {
  *graph.floors[0].z_m += 0.05;
  *graph.floors[1].z_m -= 0.29;
  const FloorResult result = judge();
  EXPECT_EQ(result.numAsked(), 2u);
  EXPECT_EQ(result.numFound(), 2u);
  EXPECT_EQ(result.numFalse(), 0u);
  EXPECT_NEAR(*result.storeys[0].height_error_m, 0.05, 1e-9);
  EXPECT_NEAR(*result.storeys[1].height_error_m, -0.29, 1e-9);
}

TEST_F(FloorErrorTest, BeyondThirtyCentimetresIsMissedAndFalse) {
  *graph.floors[1].z_m += 0.31;
  const FloorResult result = judge();
  EXPECT_EQ(result.numFound(), 1u);
  EXPECT_FALSE(result.storeys[1].estimate);
  EXPECT_NE(result.estimates[1].why_false, "");
}

TEST_F(FloorErrorTest, ASecondFloorAtOneHeightIsFalse) {
  graph.floors.push_back({"f2", graph.floors[0].center, *graph.floors[0].z_m + 0.1});
  const FloorResult result = judge();
  EXPECT_EQ(result.numFound(), 2u);
  EXPECT_EQ(result.numFalse(), 1u);
  EXPECT_NE(result.estimates[2].why_false, "");
}

TEST_F(FloorErrorTest, WithoutAHeightItIsFoundWithoutOne) {
  graph.floors[1].z_m.reset();
  const FloorResult result = judge();
  EXPECT_EQ(result.numFound(), 2u);
  EXPECT_EQ(*result.storeys[1].estimate, 1u);
  EXPECT_FALSE(result.storeys[1].height_error_m);
  graph.floors.push_back({"f2", {0, 0}, std::nullopt});
  EXPECT_EQ(judge().numFalse(), 1u);
}

TEST_F(FloorErrorTest, StoreysThatThePathIsNotOnAreNotAskedFor) {
  house.plan.floors_z_m.push_back(6.4);
  EXPECT_EQ(judge().numAsked(), 2u);
  graph.floors.push_back({"f2", {0, 0}, 6.4 + kMapOfHouse.translation.z()});
  EXPECT_EQ(judge().numFound(), 2u);
  EXPECT_EQ(judge().numFalse(), 0u);
}

// Off by 1 cm below, by 3 cm above.
TEST_F(FloorErrorTest, AbsoluteErrorOfEachStorey) {
  AbsoluteError error;
  for (size_t i = 0; i < house.poses.size(); i += 10)
    error.over_time.emplace_back(house.poses[i].time, house.poses[i].pose.translation.z() > 3 ? 0.03 : 0.01);
  const auto by_storey = errorByStorey(house.plan, house.poses, error);
  ASSERT_EQ(by_storey.size(), 3u);
  EXPECT_EQ(*by_storey[0].storey, 0u);
  EXPECT_NEAR(by_storey[0].translation_m.rmse, 0.01, 1e-12);
  EXPECT_NEAR(by_storey[1].translation_m.rmse, 0.03, 1e-12);
  EXPECT_FALSE(by_storey[2].storey);
  EXPECT_EQ(
      by_storey[0].translation_m.count + by_storey[1].translation_m.count + by_storey[2].translation_m.count,
      error.over_time.size());
}

}  // namespace
}  // namespace sgraphs
