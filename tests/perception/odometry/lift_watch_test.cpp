#include "perception/odometry/lift_watch.h"

#include <gtest/gtest.h>

#include "perception/odometry/surfel.h"
#include "tests/perception/odometry/simulated_walk.h"

namespace sgraphs {
namespace {

using Event = LiftWatch::Event;
using testing_support::poseOf;

constexpr double kDoor_m = 1.1;

// A lift's car of 1.9 x 2 m at the end of a lobby of 6 x 5 m; its door stands open, or is shut.
simulate::Scene lobby(bool open) {
  simulate::Scene scene = simulate::makeBoxRoom(8, 5);
  const auto wall = [&](const char* name, double x, double y, double size_x, double size_y) {
    scene.boxes.push_back({name, {x, y}, {size_x, size_y}, 0, 2.8, 0});
  };
  wall("left", 6.95, 3.75, 2.1, 0.5);
  wall("left", 6.95, 4.5, 2.1, 1.0);
  wall("right", 6.95, 0.75, 2.1, 1.5);
  const double jamb_m = 0.5 * (2.0 - kDoor_m);
  wall("jamb", 5.95, 1.5 + 0.5 * jamb_m, 0.1, jamb_m);
  wall("jamb", 5.95, 3.5 - 0.5 * jamb_m, 0.1, jamb_m);
  if (!open) wall("door", 5.95, 2.5, 0.1, kDoor_m);
  return scene;
}

const SE3 kInCar = poseOf({7.0, 2.5, 0.52}, 0, 0, 0), kInLobby = poseOf({3.0, 2.5, 0.52}, 0, 0, 0);
const SE3 kLidar = poseOf({0.12, 0, 0.31}, 0, 0, 0);

class LiftWatchTest : public testing::Test {
 protected:
  // Stands there; the last event that is one.
  Event stand(bool open, const SE3& T_building_body, double seconds, const SE3& T_odom_body) {
    const LidarScan seen = simulateScan(open ? open_ : shut_, T_building_body * kLidar);
    const std::vector<int32_t> kept = prefilter(seen, kLidar, PrefilterConfig());
    Event last = Event::kNone;
    for (int i = 0; i < static_cast<int>(10 * seconds); ++i) {
      LidarScan scan = seen;
      scan.end = time_ = time_ + Duration::fromSeconds(0.1);
      const Event event = watch_.step(scan, kept, kLidar, T_odom_body);
      if (event != Event::kNone) last = event;
    }
    return last;
  }
  Event stand(bool open, const SE3& T_building_body, double seconds) {
    return stand(open, T_building_body, seconds, T_building_body);
  }

  simulate::SimulatedWorld open_{lobby(true)}, shut_{lobby(false)};
  LiftWatch watch_{LiftConfig{}};
  Time time_{1'000'000};
};

TEST_F(LiftWatchTest, ADoorThatClosesAndOpensIsARide) {
  EXPECT_EQ(stand(true, kInLobby, 2), Event::kNone);
  EXPECT_EQ(stand(true, kInCar, 2), Event::kNone);
  EXPECT_EQ(stand(false, kInCar, 2.5), Event::kNone) << "too short";
  EXPECT_EQ(stand(false, kInCar, 5), Event::kShutIn);
  EXPECT_EQ(stand(true, kInCar, 1), Event::kLetOut);
  EXPECT_EQ(stand(true, kInCar, 5), Event::kNone) << "once";
  EXPECT_EQ(stand(false, kInCar, 4), Event::kShutIn) << "the next ride";
}

TEST_F(LiftWatchTest, ARobotMayTurnInTheCar) {
  stand(true, kInCar, 2);
  stand(false, kInCar, 2);
  const SE3 turned = poseOf({7.05, 2.45, 0.52}, 0, 0, 130);
  EXPECT_EQ(stand(false, turned, 4), Event::kShutIn);
  EXPECT_EQ(stand(true, turned, 1), Event::kLetOut);
}

TEST_F(LiftWatchTest, ADoorThatClosesForAMomentIsNoRide) {
  stand(true, kInCar, 2);
  EXPECT_EQ(stand(false, kInCar, 2), Event::kNone);
  EXPECT_EQ(stand(true, kInCar, 5), Event::kNone);
}

TEST_F(LiftWatchTest, OpenSpacesOfAnySizeAreNoRide) {
  EXPECT_EQ(stand(true, kInLobby, 10), Event::kNone);
  EXPECT_EQ(stand(true, kInCar, 10), Event::kNone);
  EXPECT_EQ(stand(false, kInLobby, 10), Event::kNone) << "a lobby with its lift's door shut";
  EXPECT_EQ(stand(true, kInLobby, 10), Event::kNone);
}

// A robot that was switched on in a closed cupboard, or whose pose jumps while it is in one.
TEST_F(LiftWatchTest, OnlyADoorThatClosesBehindAStandingRobotCounts) {
  EXPECT_EQ(stand(false, kInCar, 10), Event::kNone);
  EXPECT_EQ(stand(true, kInCar, 2), Event::kNone);
  stand(false, kInCar, 2);
  const SE3 elsewhere = poseOf({9.0, 2.5, 0.52}, 0, 0, 0);
  EXPECT_EQ(stand(false, kInCar, 10, elsewhere), Event::kNone) << "it walks in a closed space";
}

TEST_F(LiftWatchTest, IsSwitchedOff) {
  LiftConfig config;
  config.enabled = false;
  watch_ = LiftWatch(config);
  stand(true, kInCar, 2);
  EXPECT_EQ(stand(false, kInCar, 10), Event::kNone);
  EXPECT_EQ(stand(true, kInCar, 2), Event::kNone);
}

}  // namespace
}  // namespace sgraphs
