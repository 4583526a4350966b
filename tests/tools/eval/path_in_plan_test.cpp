#include "tools/eval/path_in_plan.h"

#include <gmock/gmock.h>

#include "tests/tools/eval/house.h"

namespace sgraphs {
namespace {

using testing::ElementsAre;

TEST(RoomVisitsTest, SecondsInsideAndTheFirstOne) {
  const test::House house;
  const auto visits = roomVisits(house.plan, house.poses);
  EXPECT_NEAR(visits[0].inside_s, 23, 0.05);  // 20 s standing, 3 m to its edge
  EXPECT_EQ(*visits[0].entered, test::House::kStart);
  EXPECT_NEAR(visits[1].inside_s, 1 + 10 + 3, 0.05);
  EXPECT_NEAR((*visits[1].entered - test::House::kStart).seconds(), 23.2, 0.05);
  EXPECT_EQ(visits[3].inside_s, 0);
  EXPECT_FALSE(visits[3].entered);
  // Room U1 lies above R1.
  EXPECT_NEAR(visits[4].inside_s, 2 + 5, 0.05);
  EXPECT_THAT(askedRooms(house.plan, visits), ElementsAre(true, true, false, false, true));
}

TEST(RoomVisitsTest, AStepInsideAndBackIsNoFirstSecond) {
  test::House house;
  std::vector<StampedPose> poses;
  // Half a second inside, one outside, then two inside.
  for (int i = 0; i < 350; ++i) {
    const bool inside = i < 50 || i >= 150;
    poses.push_back({test::House::kStart + Duration{i * 10'000},
                     {Eigen::Quaterniond::Identity(), {inside ? 2.0 : 20.0, 2, 0.5}}});
  }
  const RoomVisit visit = roomVisits(house.plan, poses)[0];
  EXPECT_NEAR(visit.inside_s, 2.5, 0.02);
  EXPECT_NEAR((*visit.entered - test::House::kStart).seconds(), 1.5, 0.02);
}

TEST(RoomVisitsTest, GapsOfTheTruthCountForNoRoom) {
  test::House house;
  house.poses.erase(house.poses.begin() + 100, house.poses.begin() + 1100);
  EXPECT_NEAR(roomVisits(house.plan, house.poses)[0].inside_s, 13, 0.05);
}

TEST(StoreyAtTest, StairsBelongToNone) {
  const test::House house;
  EXPECT_EQ(storeyAt(house.plan, 0.5), 0u);
  EXPECT_EQ(storeyAt(house.plan, 1.59), 0u);
  EXPECT_FALSE(storeyAt(house.plan, 2.5));
  EXPECT_EQ(storeyAt(house.plan, 3.1), 1u);
  EXPECT_FALSE(storeyAt(house.plan, -1));
}

TEST(DoorwaysTest, ThresholdsLieAlongTheirWall) {
  test::House house;
  const auto [begin, end] = *thresholdOf(house.plan, house.plan.doorways[0]);
  EXPECT_LT((begin - Eigen::Vector2d(4.1, 0.55)).norm(), 1e-9);
  EXPECT_LT((end - Eigen::Vector2d(4.1, 1.45)).norm(), 1e-9);
  EXPECT_FALSE(thresholdOf(house.plan, house.plan.doorways[3]));  // the wall is a storey below
  EXPECT_FALSE(thresholdOf(house.plan, house.plan.doorways[4]));
}

TEST(DoorwaysTest, WalkedThroughAreThoseWhoseThresholdIsCrossed) {
  test::House house;
  // Beside doorway 1 in the corridor, at 0.4 m from its middle but never across it.
  house.plan.doorways.push_back({0, {5.2, 6.1, 0}, 0.9});
  EXPECT_THAT(walkedThrough(house.plan, house.poses), ElementsAre(true, false, true, true, false, false));
}

}  // namespace
}  // namespace sgraphs
