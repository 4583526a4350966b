#include "perception/rooms/storey_tracker.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/perception/rooms/plan_world.h"

namespace sgraphs::test {
namespace {

constexpr double kBody_m = 0.52;

// A walk along x, one keyframe a metre, with a gait that bobs.
class StoreyTrackerTest : public testing::Test {
 protected:
  // To the height z [m] above the start over a distance; returns the storey of the last keyframe.
  FloorId walk(double distance_m, double z_m, double step_m = 1.0) {
    const int n = static_cast<int>(std::lround(distance_m / step_m));
    const double begin = z_;
    for (int i = 1; i <= n; ++i) {
      x_ += step_m;
      z_ = begin + (z_m - begin) * i / n;
      add(z_);
    }
    return last();
  }
  void add(double z_m) {
    const int64_t id = static_cast<int64_t>(keyframes_.size());
    const double bob = 0.015 * std::sin(static_cast<double>(17 * id));
    keyframes_[KeyframeId{id}] = keyframeAt(id, {x_, 0}, kBody_m + z_m + bob);
    for (const KeyframeFloor& change : tracker_.step(keyframes_)) told_[change.keyframe] = change.floor;
  }
  FloorId last() const { return told_.at(keyframes_.rbegin()->first); }
  int64_t count(FloorId floor) const {
    return std::count_if(told_.begin(), told_.end(),
                         [&](const auto& entry) { return entry.second == floor; });
  }

  StoreyTracker tracker_{StoreyConfig{}};
  std::map<KeyframeId, MapKeyframe> keyframes_;
  std::map<KeyframeId, FloorId> told_;  // as the changes add up
  double x_ = 0, z_ = 0;
};

TEST_F(StoreyTrackerTest, EveryKeyframeIsToldOnceAndOnlyChangesAfterwards) {
  keyframes_[KeyframeId{0}] = keyframeAt(0, {0, 0});
  EXPECT_EQ(tracker_.step(keyframes_).size(), 1u);
  EXPECT_TRUE(tracker_.step(keyframes_).empty());
}

TEST_F(StoreyTrackerTest, StairsLeadToANewStoreyAndBackToTheFirst) {
  EXPECT_EQ(walk(10, 0), FloorId{0});
  EXPECT_FALSE(walk(5, 3.2).valid()) << "on the stairs";
  EXPECT_EQ(walk(3, 3.2), FloorId{1});
  EXPECT_EQ(walk(10, 3.2), FloorId{1});
  EXPECT_FALSE(walk(5, 0).valid());
  EXPECT_EQ(walk(4, 0), FloorId{0}) << "known by its height";
  EXPECT_FALSE(walk(5, 3.2).valid());
  EXPECT_EQ(walk(3, 3.2), FloorId{1});
  EXPECT_GE(count(FloorId{}), 9) << "the flights belong to neither";
  EXPECT_LE(count(FloorId{}), 15);
  EXPECT_NEAR(tracker_.bodyHeights().at(FloorId{1}), 3.2 + kBody_m, 0.02);
}

TEST_F(StoreyTrackerTest, FinelySpacedKeyframesTellTheSame) {
  EXPECT_EQ(walk(6, 0, 0.25), FloorId{0});
  EXPECT_FALSE(walk(5, -2.9, 0.25).valid());
  EXPECT_EQ(walk(3, -2.9, 0.25), FloorId{1});
  EXPECT_FALSE(walk(5, 0, 0.25).valid());
  EXPECT_EQ(walk(3, 0, 0.25), FloorId{0});
}

TEST_F(StoreyTrackerTest, RampAndStepsOfLessThanAMetreStayOnTheStorey) {
  walk(8, 0);
  walk(3, 0.8);
  EXPECT_EQ(walk(4, 0.8), FloorId{0});
  walk(3, 0);
  EXPECT_EQ(walk(4, 0), FloorId{0});
  EXPECT_EQ(count(FloorId{0}), static_cast<int64_t>(keyframes_.size())) << "none is left between storeys";
}

// Wheelchair ramps (1:12) and the steeper ones of garages: one storey, the way, the other; and back.
TEST_F(StoreyTrackerTest, ARampLeadsToANewStoreyWithoutFlicker) {
  for (const double slope : {1.0 / 15, 1.0 / 12, 0.14})
    for (const double step_m : {0.25, 1.0}) {
      SCOPED_TRACE(testing::Message() << "slope " << slope << ", step " << step_m);
      tracker_ = StoreyTracker{StoreyConfig{}};
      keyframes_.clear();
      told_.clear();
      x_ = z_ = 0;
      std::vector<FloorId> seen;
      const auto note = [&](double distance_m, double z_m) {
        const double begin = z_;
        const int n = static_cast<int>(std::ceil(distance_m / step_m));
        for (int i = 1; i <= n; ++i) {
          const FloorId now = walk(step_m, begin + (z_m - begin) * i / n, step_m);
          if (seen.empty() || seen.back() != now) seen.push_back(now);
        }
      };
      note(12, 0);
      note(3.2 / slope, 3.2);
      note(12, 3.2);
      note(3.2 / slope, 0);
      note(12, 0);
      const std::vector<FloorId> expected = {FloorId{0}, FloorId{}, FloorId{1}, FloorId{}, FloorId{0}};
      EXPECT_EQ(seen, expected);
      EXPECT_EQ(tracker_.bodyHeights().size(), 2u);
      EXPECT_NEAR(tracker_.bodyHeights().at(FloorId{1}), 3.2 + kBody_m, 0.05);
      EXPECT_NEAR(tracker_.bodyHeights().at(FloorId{0}), kBody_m, 0.05);
    }
}

TEST_F(StoreyTrackerTest, AGentleRampWithinAStoreyLeavesNothingBetween) {
  walk(10, 0);
  walk(8, 0.6);
  walk(10, 0.6);
  EXPECT_EQ(last(), FloorId{0});
  EXPECT_EQ(count(FloorId{0}), static_cast<int64_t>(keyframes_.size()));
  EXPECT_EQ(tracker_.bodyHeights().size(), 1u);
}

TEST_F(StoreyTrackerTest, LandingHalfWayIsNoStorey) {
  walk(8, 0);
  walk(3, 1.6);
  EXPECT_FALSE(walk(2, 1.6).valid());
  walk(3, 3.2);
  EXPECT_EQ(walk(4, 3.2), FloorId{1});
  EXPECT_EQ(tracker_.bodyHeights().size(), 2u);
}

TEST_F(StoreyTrackerTest, StandingChangesNothing) {
  walk(5, 0);
  for (int i = 0; i < 10; ++i) add(0);
  EXPECT_EQ(walk(5, 0), FloorId{0});
  EXPECT_EQ(tracker_.bodyHeights().size(), 1u);
}

// The odometry puts every floor to which a lift leads far from all others; loops tell that one is known.
TEST_F(StoreyTrackerTest, LiftsLeadToNewStoreysAndThoseThatComeToLieTogetherAreOne) {
  walk(10, 0);
  add(z_ = 20);
  EXPECT_EQ(walk(8, 20), FloorId{1});
  add(z_ = 40);
  EXPECT_EQ(walk(8, 40), FloorId{2});
  const int64_t newest = static_cast<int64_t>(keyframes_.size());
  for (auto& [id, keyframe] : keyframes_)
    if (keyframe.T_map_body.translation.z() > 30) keyframe.T_map_body.translation.z() -= 40;
  z_ = 0;
  EXPECT_EQ(walk(2, 0), FloorId{0});
  EXPECT_EQ(tracker_.bodyHeights().size(), 2u);
  EXPECT_EQ(count(FloorId{2}), 0);
  EXPECT_EQ(told_.at(KeyframeId{newest - 1}), FloorId{0});
  EXPECT_EQ(count(FloorId{1}), 9);
  add(z_ = 60);
  EXPECT_EQ(walk(8, 60), FloorId{3}) << "ids are not used again";
}

// The next session began upstairs.
TEST_F(StoreyTrackerTest, ARobotThatIsCarriedIsOnTheStoreyOfItsHeight) {
  walk(10, 0);
  walk(5, 3.2);
  walk(6, 3.2);
  walk(5, 0);
  EXPECT_EQ(walk(6, 0), FloorId{0});
  for (const double away_m : {20.0, 0.3}) {
    x_ += away_m;
    add(z_ = 3.2);
    EXPECT_EQ(last(), FloorId{1});
    EXPECT_EQ(walk(6, 3.2), FloorId{1});
    x_ += away_m;
    add(z_ = 0);
    EXPECT_EQ(last(), FloorId{0});
    EXPECT_EQ(walk(6, 0), FloorId{0});
  }
  x_ += 3;
  add(z_ = 1.6);
  EXPECT_FALSE(last().valid()) << "on the stairs";
  walk(3, 3.2);
  EXPECT_EQ(walk(4, 3.2), FloorId{1});
  EXPECT_EQ(tracker_.bodyHeights().size(), 2u);
}

TEST_F(StoreyTrackerTest, GaitAndSlowDriftAreNoClimb) {
  for (int i = 0; i < 60; ++i) EXPECT_EQ(walk(1, z_ + 0.02), FloorId{0});
}

}  // namespace
}  // namespace sgraphs::test
