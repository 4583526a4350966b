// What may come in besides a clean stream: lost, empty, poor and impossible scans, and jumps.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "perception/odometry/odometry.h"
#include "tests/perception/odometry/simulated_walk.h"
#include "tools/simulate/scene/find_scene.h"
#include "tools/simulate/scene/scene_file.h"

namespace sgraphs {
namespace {

using namespace testing_support;

const SE3 kStand = poseOf({2.5, 2.2, 0.52}, 0, 0, 15);

// Scans of a robot walking straight at 0.7 m/s, with exact legs.
SimulatedWalk straightWalk(double seconds, const simulate::SensorModel& model = {}) {
  const simulate::SimulatedWorld world(simulate::makeBoxRoom(7, 5, 2.7));
  Vector6d twist = Vector6d::Zero();
  twist[0] = 0.7;
  const auto truth = simulate::Trajectory::constantTwist(world.scene.start, Duration::fromSeconds(seconds),
                                                         poseOf({1.5, 2.2, 0.52}, 0, 0, 10), twist);
  const SE3 mount = world.scene.T_body_lidar;
  const simulate::SensorSimulator sensor(world.caster, truth, mount, model, 9);
  SimulatedWalk walk{truth, mount, {}, simulate::simulateLegsOdometry(truth, exactLegs(), 1)};
  for (int64_t i = 0; i < sensor.numScans(); ++i) walk.scans.push_back(sensor.scan(i));
  return walk;
}

// Largest distance of the estimates from the truth, both since the first scan.
double worstError(const OdometryRun& run, const SimulatedWalk& walk) {
  double worst = 0;
  const OdometryEstimate& first = run.estimates.front();
  for (const OdometryEstimate& e : run.estimates) {
    const SE3 estimated = first.T_odom_body.inverse() * e.T_odom_body;
    worst = std::max(
        worst, distance(estimated, walk.truth.poseAt(first.time).inverse() * walk.truth.poseAt(e.time)));
  }
  return worst;
}

void expectFinite(const OdometryRun& run) {
  for (const OdometryEstimate& e : run.estimates) {
    EXPECT_TRUE(e.T_odom_body.isFinite());
    EXPECT_TRUE(e.twist_body.allFinite());
    EXPECT_TRUE(e.covariance.allFinite());
    EXPECT_GT(e.covariance.diagonal().minCoeff(), 0);
  }
  for (const Keyframe& k : run.keyframes) {
    for (const KeyframePoint& p : k.points) EXPECT_TRUE(p.position_body.allFinite());
    for (const RelativePose& r : k.relative_poses) {
      EXPECT_TRUE(r.T_from_to.isFinite());
      EXPECT_TRUE(r.covariance.allFinite());
    }
  }
}

TEST(OdometryOdditiesTest, SurvivesLostScans) {
  for (const size_t lost : {1u, 3u, 8u}) {
    SimulatedWalk walk = straightWalk(2.6);
    walk.scans.erase(walk.scans.begin() + 8, walk.scans.begin() + 8 + static_cast<std::ptrdiff_t>(lost));
    for (const OdometryMode mode : {OdometryMode::kLidar, OdometryMode::kFused, OdometryMode::kEncoder}) {
      // After 0.8 s without any, LiDAR alone would have to find itself over half a metre: beyond its gate.
      if (lost == 8 && mode == OdometryMode::kLidar) continue;
      const OdometryRun run = runOdometry(walk, mode);
      expectFinite(run);
      EXPECT_EQ(run.estimates.size(), walk.scans.size());
      EXPECT_LT(worstError(run, walk), 0.02) << lost << " lost in mode " << toString(mode);
    }
  }
}

// Regression: the first scan behind a silence was registered against the map from before, wherever the robot
// had gone meanwhile, and its edge said that it was certain.
TEST(OdometryOdditiesTest, AfterALongSilenceWithoutLegsNothingIsClaimedOfTheWay) {
  SimulatedWalk walk = straightWalk(6);
  const Time before = walk.scans[11].end;
  walk.scans.erase(walk.scans.begin() + 12, walk.scans.begin() + 37);
  const OdometryRun run = runOdometry(walk, OdometryMode::kLidar);
  expectFinite(run);
  int bridges = 0;
  for (const Keyframe& keyframe : run.keyframes)
    for (const RelativePose& r : keyframe.relative_poses) {
      const auto poseAt = [&](KeyframeId id) {
        return walk.truth.poseAt(run.keyframes.at(static_cast<size_t>(id.value)).time);
      };
      const auto timeOf = [&](KeyframeId id) { return run.keyframes.at(static_cast<size_t>(id.value)).time; };
      const Vector6d error = se3Log(r.T_from_to.inverse() * poseAt(r.from).inverse() * poseAt(r.to));
      EXPECT_LT(error.dot(r.covariance.ldlt().solve(error)), 22.5) << "99.9 % of 6 degrees of freedom";
      if (timeOf(r.from) > before || timeOf(r.to) <= before) continue;
      ++bridges;
      EXPECT_EQ(r.kind, RelativePoseKind::kOdometry) << "no cloud from before is the neighbour of one behind";
      EXPECT_GT(r.covariance(0, 0), 2.0);
    }
  EXPECT_EQ(bridges, 1);
  // Legs know the way.
  EXPECT_LT(worstError(runOdometry(walk, OdometryMode::kFused), walk), 0.02);
}

TEST(OdometryOdditiesTest, RefusesScansThatTellNothing) {
  SimulatedWalk walk = straightWalk(1.2);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  LidarScan poor = walk.scans[4], empty = walk.scans[5], broken = walk.scans[6];
  poor.points.resize(400);
  empty.points.clear();
  for (LidarPoint& p : broken.points) p.position_lidar = {nan, nan, nan};
  Odometry odometry(OdometryConfig(), OdometryMode::kLidar, walk.T_body_lidar);
  for (size_t i = 0; i < walk.scans.size(); ++i) {
    const bool spoilt = i >= 4 && i <= 6;
    const LidarScan& scan = i == 4 ? poor : i == 5 ? empty : i == 6 ? broken : walk.scans[i];
    const auto estimate = odometry.step(scan, {});
    EXPECT_EQ(estimate.has_value(), !spoilt);
    if (!estimate) continue;
    const SE3 truth = walk.truth.poseAt(walk.scans[0].end).inverse() * walk.truth.poseAt(scan.end);
    EXPECT_LT(distance(truth, estimate->T_odom_body), 0.02);
  }
  // Also as the first ones.
  Odometry fresh(OdometryConfig(), OdometryMode::kLidar, walk.T_body_lidar);
  EXPECT_FALSE(fresh.step(empty, {}));
  EXPECT_FALSE(fresh.step(broken, {}));
  EXPECT_TRUE(fresh.step(walk.scans[7], {}));
}

TEST(OdometryOdditiesTest, RefusesTimeThatRunsBackwardsAndGoesOn) {
  const SimulatedWalk walk = straightWalk(1.5);
  SimulatedWalk odd = walk;
  LidarScan again = walk.scans[5], ancient = walk.scans[5], endless = walk.scans[6];
  ancient.begin = Time{0};
  ancient.end = Time{100'000};
  endless.begin = Time{0};  // ends in order, but is said to have begun decades ago
  odd.scans.insert(odd.scans.begin() + 6, {again, ancient, endless});
  for (const OdometryMode mode : {OdometryMode::kLidar, OdometryMode::kFused, OdometryMode::kEncoder}) {
    const OdometryRun run = runOdometry(odd, mode), clean = runOdometry(walk, mode);
    ASSERT_EQ(run.estimates.size(), clean.estimates.size());
    for (size_t i = 0; i < run.estimates.size(); ++i)
      EXPECT_EQ(run.estimates[i].T_odom_body.translation, clean.estimates[i].T_odom_body.translation);
  }
}

TEST(OdometryOdditiesTest, StaysFiniteThroughAHugeJump) {
  SimulatedWalk walk = straightWalk(3.0);
  // The second half of the walk takes place elsewhere: carried off, while the legs saw nothing.
  const simulate::SimulatedWorld elsewhere(simulate::makeBoxRoom(12, 4, 3.1));
  const auto still = simulate::Trajectory::still(walk.scans[10].begin, Duration::fromSeconds(2.0),
                                                 poseOf({9, 1.4, 0.52}, 0, 0, 140));
  const simulate::SensorSimulator sensor(elsewhere.caster, still, walk.T_body_lidar, {}, 3);
  for (size_t i = 10; i < walk.scans.size() && static_cast<int64_t>(i) - 10 < sensor.numScans(); ++i) {
    const LidarScan other = sensor.scan(static_cast<int64_t>(i) - 10);
    walk.scans[i].points = other.points;
  }
  for (const OdometryMode mode : {OdometryMode::kLidar, OdometryMode::kFused}) {
    const OdometryRun run = runOdometry(walk, mode);
    EXPECT_EQ(run.estimates.size(), walk.scans.size());
    expectFinite(run);
    for (const OdometryEstimate& e : run.estimates) EXPECT_LT(e.T_odom_body.translation.norm(), 20);
  }
}

TEST(OdometryOdditiesTest, JumpOfTheLegsLeavesTheLidarsPoseFinite) {
  SimulatedWalk walk = straightWalk(2.0);
  for (BodyOdometry& sample : walk.legs)
    if (sample.time > walk.scans[10].begin)
      sample.T_odom_body = poseOf({500, -300, 2}, 0, 0, 100) * sample.T_odom_body;
  for (const OdometryMode mode : {OdometryMode::kFused, OdometryMode::kEncoder})
    expectFinite(runOdometry(walk, mode));
}

TEST(OdometryOdditiesTest, FusedWithoutLegsIsLidar) {
  SimulatedWalk walk = straightWalk(1.5);
  walk.legs.clear();
  const OdometryRun run = runOdometry(walk, OdometryMode::kFused);
  EXPECT_LT(worstError(run, walk), 0.02);
  EXPECT_TRUE(run.estimates.back().extrapolated) << "and says that the legs were missing";
}

TEST(OdometryOdditiesTest, FollowsDeskewedScansWithoutFiringTimes) {
  // Each scan as another program would have deskewed it to its end, unorganised.
  SimulatedWalk walk = straightWalk(3.5);
  for (LidarScan& scan : walk.scans) {
    const SE3 T_end = walk.truth.poseAt(scan.end) * walk.T_body_lidar;
    for (LidarPoint& p : scan.points) {
      const SE3 T = walk.truth.poseAt(scan.end + Duration{p.time_us}) * walk.T_body_lidar;
      p.position_lidar = (T_end.inverse() * (T * p.position_lidar.cast<double>())).cast<float>();
      p.time_us = 0;
      p.column = 0;
      p.ring = 0;
    }
    scan.begin = scan.end;
    scan.num_rings = 0;
    scan.deskewed = true;
  }
  for (const OdometryMode mode : {OdometryMode::kLidar, OdometryMode::kFused, OdometryMode::kEncoder}) {
    const OdometryRun run = runOdometry(walk, mode);
    ASSERT_EQ(run.estimates.size(), walk.scans.size());
    EXPECT_LT(worstError(run, walk), 0.03) << toString(mode);
    EXPECT_NEAR(run.estimates.back().twist_body[0], 0.7, 0.15) << toString(mode);
  }
}

TEST(OdometryOdditiesTest, StandingStillNeitherDriftsNorGrows) {
  const simulate::SimulatedWorld world(simulate::makeBoxRoom(6, 5, 2.8));
  const SE3 mount = world.scene.T_body_lidar;
  const auto still = simulate::Trajectory::still(world.scene.start, Duration::fromSeconds(0.85), kStand);
  const simulate::SensorSimulator sensor(world.caster, still, mount, {}, 2);
  std::vector<LidarScan> scans;
  for (int64_t i = 0; i < sensor.numScans(); ++i) scans.push_back(sensor.scan(i));
  Odometry odometry(OdometryConfig(), OdometryMode::kLidar, mount);
  int keyframes = 0;
  for (size_t i = 0; i < 150; ++i) {
    LidarScan scan = scans[i % scans.size()];
    const Duration later{static_cast<int64_t>(i / scans.size()) * 100'000 *
                         static_cast<int64_t>(scans.size())};
    scan.begin = scan.begin + later;
    scan.end = scan.end + later;
    const auto estimate = odometry.step(scan, {});
    ASSERT_TRUE(estimate);
    EXPECT_LT(estimate->T_odom_body.translation.norm(), 0.008);
    keyframes += estimate->is_keyframe;
  }
  EXPECT_EQ(keyframes, 1);
}

// Somebody who stands in a corridor in front of the robot tells more of the way along it than all its door
// frames do; when he walks off ahead, the robot must not take itself for standing. It fell 6 m behind.
TEST(OdometryOdditiesTest, SomebodyWhoWalksAheadInACorridorDoesNotTakeTheRobotAlong) {
  simulate::Scene scene = simulate::loadScene(simulate::findScene("se2"));
  ASSERT_FALSE(scene.people.empty());
  scene.path.waypoints.resize(4);  // along the corridor and into the first office
  const SimulatedWalk walk = walkThrough(scene, 1);
  EXPECT_LT(trajectoryError(runOdometry(walk, OdometryMode::kLidar), walk.truth), 0.05);
}

// A walk along the northern corridor of se2, with nobody in it, and round on the spot.
SimulatedWalk corridorWalk(double from_x, double to_x) {
  simulate::Scene scene = simulate::loadScene(simulate::findScene("se2"));
  scene.people.clear();
  scene.path.speed_mps = 1.0;
  scene.path.start_pause_s = 1;
  scene.path.end_pause_s = 1;
  scene.path.start_heading_rad = M_PI;
  simulate::Waypoint turn{{to_x, 25.9}, 1.0};
  scene.path.waypoints = {{{from_x, 25.9}, 0}, turn, {{to_x + 1.0, 25.9}, 0}};
  return walkThrough(scene, 10);
}

// Regression: the begin of a scan could leave the end of the one before by centimetres. In a corridor each
// wall is seen at its own time of the sweep, so scans and map agreed on a bend that grew to 13 mm per scan: a
// standing robot had a velocity of 0.13 m/s across the corridor, and when it turned on the spot, bend and map
// parted and the odometry ran off by metres.
TEST(OdometryOdditiesTest, ACorridorDoesNotBendScansAndTurningInItIsFollowed) {
  const SimulatedWalk walk = corridorWalk(40.0, 16.0);
  const OdometryRun run = runOdometry(walk, OdometryMode::kLidar);
  double fastest = 0, standing = 0;
  for (const OdometryEstimate& e : run.estimates) {
    const double speed = e.twist_body.head<2>().norm();
    const SE3 before = walk.truth.poseAt(e.time - Duration::fromSeconds(0.5));
    const SE3 truth = walk.truth.poseAt(e.time);
    if (distance(before, truth) < 1e-6 && angle(before, truth) < 1e-6) standing = std::max(standing, speed);
    fastest = std::max(fastest, speed);
  }
  EXPECT_LT(standing, 0.06);
  EXPECT_LT(fastest, 1.3);
  EXPECT_LT(trajectoryError(run, walk.truth), 0.02);
}

// Floor and ceiling, which alone tell the pitch there, are seen at one part of each sweep only. A begin held
// tighter than it was known made the robot nod: the error grew 2.4-fold from scan to scan, up to 22 degrees.
TEST(OdometryOdditiesTest, ARobotThatWakesInACorridorDoesNotNod) {
  simulate::Scene scene = simulate::loadScene(simulate::findScene("lc1"));
  scene.path.waypoints = {{{2.2, 7.1}}, {{6.2, 7.1}}};
  const SimulatedWalk walk = walkThrough(scene, 1);
  const OdometryRun run = runOdometry(walk, OdometryMode::kLidar);
  ASSERT_GT(run.estimates.size(), 50u);
  const SE3 T_odom_truth = run.estimates[0].T_odom_body * walk.truth.poseAt(run.estimates[0].time).inverse();
  for (const OdometryEstimate& e : run.estimates)
    ASSERT_LT(angle(e.T_odom_body, T_odom_truth * walk.truth.poseAt(e.time)), 0.02)
        << (e.time - walk.truth.start()).seconds() << " s";
}

// A cabinet that is passed at half a metre meets a hundred patches of each scan, all of which err by what is
// wrong with one plane. They outvoted the far ends of the corridor, which alone tell the place along it: the
// robot slid by 0.36 m.
TEST(OdometryOdditiesTest, ACabinetPassedCloselyDoesNotDragTheRobotAlongACorridor) {
  simulate::Scene scene = simulate::loadScene(simulate::findScene("lc1"));
  scene.people.clear();
  scene.path.waypoints = {{{27.5, 7.1}}, {{38.0, 7.1}}};
  const SimulatedWalk walk = walkThrough(scene, 1);
  EXPECT_LT(trajectoryError(runOdometry(walk, OdometryMode::kLidar), walk.truth), 0.02);
}

// One floor up in the lift of the scene of that name, whose doors open on a lobby that looks like the one
// below: without the ride both would be one place.
TEST(OdometryOdditiesTest, ALiftLeadsToAFloorOfItsOwn) {
  simulate::Scene scene = simulate::loadScene(simulate::findScene("lift"));
  const auto ride = std::find_if(scene.path.waypoints.begin(), scene.path.waypoints.end(),
                                 [](const simulate::Waypoint& w) { return w.lift >= 0; });
  scene.path.waypoints = {
      {{9.5, 6.0}}, {{7.0, 6.0}}, *ride, {{7.0, 6.0}, 0, 0, ride->ride_m}, {{4.0, 6.0}, 0, 0, ride->ride_m}};
  const SimulatedWalk walk = walkThrough(scene, 4);
  const simulate::Ride taken = walk.truth.rides().front();
  const double rise_m = OdometryConfig().lifts.storey_offset_m;
  for (const OdometryMode mode : {OdometryMode::kLidar, OdometryMode::kFused, OdometryMode::kEncoder}) {
    const OdometryRun run = runOdometry(walk, mode);
    std::vector<RelativePose> rides;
    for (const Keyframe& k : run.keyframes)
      for (const RelativePose& z : k.relative_poses)
        if (leavesHeightOpen(z)) rides.push_back(z);
    ASSERT_EQ(rides.size(), 1u);
    EXPECT_NEAR(rides[0].T_from_to.translation.z(), rise_m, 0.1);
    EXPECT_LT(rides[0].T_from_to.translation.head<2>().norm(), 0.05 * rise_m);
    // The door begins to open at taken.arrives_s; a robot that stands beyond it is let out.
    const OdometryEstimate* before = nullptr;
    const OdometryEstimate* after = nullptr;
    for (const OdometryEstimate& e : run.estimates) {
      const double s = (e.time - walk.truth.start()).seconds();
      if (s < taken.arrives_s) before = &e;
      if (s > taken.door_opens_s && !after) after = &e;
    }
    ASSERT_TRUE(before && after);
    EXPECT_NEAR((after->T_odom_body.translation - before->T_odom_body.translation).z(), rise_m, 0.1);
    EXPECT_LT((after->T_odom_body.translation - before->T_odom_body.translation).head<2>().norm(), 0.02);
    // On both floors it walks as ever.
    const OdometryEstimate& last = run.estimates.back();
    const SE3 walked = after->T_odom_body.inverse() * last.T_odom_body;
    const SE3 truth = walk.truth.poseAt(after->time).inverse() * walk.truth.poseAt(last.time);
    const Eigen::Vector3d off = (truth.inverse() * walked).translation;
    EXPECT_LT(off.head<2>().norm(), mode == OdometryMode::kEncoder ? 0.3 : 0.03);
    // From within a car neither floor nor ceiling is seen: the height is the legs' until it has been left.
    EXPECT_LT(std::abs(off.z()), 0.2);
    // What was seen of the lobby below is not in a cloud of the floor above.
    const auto first_above = std::find_if(run.keyframes.begin(), run.keyframes.end(),
                                          [&](const Keyframe& k) { return k.id == rides[0].to; });
    ASSERT_NE(first_above, run.keyframes.end());
    for (const KeyframePoint& p : first_above->points) EXPECT_LT(std::abs(p.position_body.z()), 4);
  }
}

}  // namespace
}  // namespace sgraphs
