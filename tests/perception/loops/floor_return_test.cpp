#include <gtest/gtest.h>

#include <cmath>

#include "tests/perception/loops/loop_world.h"

namespace sgraphs {
namespace {

using test::LoopWalk;

constexpr double kRide_m = 20.0;  // what the odometry makes of a ride

// Where rides end: where the truth goes from one floor to another in no time.
std::vector<int> ridesBefore(const LoopWalk& walk) {
  std::vector<int> rides(walk.keyframes.size(), 0);
  for (size_t i = 1; i < rides.size(); ++i) {
    const double rise_m = (walk.T_building_body[i].translation - walk.T_building_body[i - 1].translation).z();
    rides[i] = rides[i - 1] + (std::abs(rise_m) > 1.0 ? 1 : 0);
  }
  return rides;
}

// What the finder accepts of the walk, round by round. Each ride leads to a floor of its own, which the map
// never joins with another, but knows where the next round needs it.
std::vector<LoopClosure> loopsOf(LoopWalk walk, const std::vector<int>& rides) {
  LoopFinder finder{LoopsConfig{}};
  std::vector<LoopClosure> accepted;
  std::vector<SE3> T_map_body;
  for (size_t i = 0; i < rides.size(); ++i) {
    SE3 T = walk.T_building_body[i];
    T.translation.z() = 0.52 + kRide_m * rides[i];
    T_map_body.push_back(T);
    Keyframe& k = walk.keyframes[i];
    k.T_odom_body = T;
    if (i == 0) continue;
    RelativePose z;
    z.from = walk.keyframes[i - 1].id;
    z.to = k.id;
    z.T_from_to = T_map_body[i - 1].inverse() * T;
    z.covariance.diagonal() << Eigen::Vector3d::Constant(1e-5), Eigen::Vector3d::Constant(1e-6);
    if (rides[i] != rides[i - 1]) z.covariance(2, 2) = kRide_m * kRide_m;
    z.registered = true;
    k.relative_poses = {z};
  }
  for (size_t round = 0; round < rides.size() + 6; ++round) {
    MapUpdate update;
    update.round = static_cast<int64_t>(round);
    update.idle = round >= rides.size();
    const size_t i = std::min(round, rides.size() - 1);
    update.newest = walk.keyframes[i].id;
    update.keyframes.push_back(
        {walk.keyframes[i].id, FloorId{rides[i]}, walk.keyframes[i].time, T_map_body[i]});
    const LoopClosures loops =
        finder.step(update.idle ? std::nullopt : std::optional<Keyframe>(walk.keyframes[i]), update);
    accepted.insert(accepted.end(), loops.accepted.begin(), loops.accepted.end());
    EXPECT_TRUE(loops.withdrawn.empty());
  }
  return accepted;
}

struct Across {
  size_t count = 0;
  double worst_m = 0;
};

// Loops between floors: how many, and how far off.
Across across(const LoopWalk& walk, const std::vector<int>& rides, const std::vector<LoopClosure>& loops) {
  Across result;
  for (const LoopClosure& loop : loops) {
    const auto from = static_cast<size_t>(loop.pose.from.value), to = static_cast<size_t>(loop.pose.to.value);
    if (rides[from] == rides[to]) continue;
    ++result.count;
    const SE3 truth = walk.T_building_body[from].inverse() * walk.T_building_body[to];
    result.worst_m = std::max(result.worst_m, (loop.pose.T_from_to.translation - truth.translation).norm());
  }
  return result;
}

// Two floors whose corridors look alike and whose rooms do not; up, and down again.
TEST(FloorReturnTest, AKnownFloorIsRecognisedWhenTheLiftBringsTheRobotBack) {
  const LoopWalk walk = test::walkThrough(test::shippedScene("lift"), 5);
  const std::vector<int> rides = ridesBefore(walk);
  ASSERT_EQ(rides.back(), 2);
  const std::vector<LoopClosure> loops = loopsOf(walk, rides);
  const Across joined = across(walk, rides, loops);
  EXPECT_GE(joined.count, 4u);
  EXPECT_LT(joined.worst_m, 0.05);
}

TEST(FloorReturnTest, AFloorThatIsReachedForTheFirstTimeIsNone) {
  LoopWalk walk = test::walkThrough(test::shippedScene("lift"), 6);
  std::vector<int> rides = ridesBefore(walk);
  const auto back = std::find(rides.begin(), rides.end(), 2);
  walk.keyframes.resize(static_cast<size_t>(back - rides.begin()));
  rides.erase(back, rides.end());
  EXPECT_EQ(across(walk, rides, loopsOf(walk, rides)).count, 0u);
}

// The same walk on three floors that are one like the other: nobody can tell to which the second ride led.
TEST(FloorReturnTest, FloorsThatAreTheSameAreNeverJoined) {
  simulate::Scene scene = simulate::makeBoxRoom(14, 9);
  scene.boxes.push_back({"cupboard", {0.3, 4.2}, {0.6, 1.6}, 0, 1.9, 0});
  scene.boxes.push_back({"locker", {6.2, 0.3}, {1.2, 0.6}, 0, 2.1, 0});
  scene.path.waypoints = {{{2, 2}, 0}, {{12, 2}, 0}, {{12, 7}, 0}, {{2, 7}, 0}, {{2, 3}, 0}};
  LoopWalk walk = test::walkThrough(scene, 5);
  const size_t n = walk.keyframes.size();
  for (size_t i = n; i < 3 * n; ++i) {
    walk.keyframes.push_back(walk.keyframes[i - n]);
    walk.keyframes.back().id = KeyframeId{static_cast<int64_t>(i)};
    walk.T_building_body.push_back(walk.T_building_body[i - n]);
    walk.T_building_body.back().translation.z() += 3.2;
  }
  const std::vector<int> rides = ridesBefore(walk);
  ASSERT_EQ(rides.back(), 2);
  EXPECT_EQ(across(walk, rides, loopsOf(walk, rides)).count, 0u);
}

}  // namespace
}  // namespace sgraphs
