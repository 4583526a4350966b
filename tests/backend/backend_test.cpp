#include "backend/backend.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "backend/levelling.h"
#include "tests/backend/batch_reference.h"
#include "tests/backend/synthetic_walk.h"

namespace sgraphs {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing_support::makeWalk;
using testing_support::Walk;

RoundOutput play(Backend& backend, const std::optional<Keyframe>& keyframe, int64_t round) {
  return backend.step({.round = round, .time = Time{1'000'000 * (round + 1)}, .keyframe = keyframe});
}

RoundOutput playAll(Backend& backend, const Walk& walk) {
  RoundOutput last;
  int64_t round = 0;
  for (const Keyframe& keyframe : walk.keyframes) last = play(backend, keyframe, round++);
  return last;
}

double distance(const SE3& a, const SE3& b) {
  return se3Log(a.inverse() * b).norm();
}

TEST(BackendTest, FirstKeyframeIsTheMapWhenNothingSaysUp) {
  Backend backend{BackendConfig{}};
  const Walk walk = makeWalk({.num_keyframes = 1, .start_tilt = {0.1, 0.2, 0}});
  const RoundOutput output = play(backend, walk.keyframes[0], 0);
  EXPECT_EQ(distance(backend.graph().keyframes.at(KeyframeId{0}).T_map_body, SE3()), 0.0);
  EXPECT_THAT(output.changed, ElementsAre(KeyframeId{0}));
  EXPECT_EQ(output.keyframe_covariance, Matrix6d(Matrix6d::Zero()));
  EXPECT_LT(distance(output.T_map_odom * walk.keyframes[0].T_odom_body, SE3()), 1e-12);
}

TEST(BackendTest, FirstKeyframeIsLevelledByItsUp) {
  Backend backend{BackendConfig{}};
  const Walk walk =
      makeWalk({.num_keyframes = 1, .up_sigma_rad = 1e-6, .start_tilt = Eigen::Vector3d(0.3, -0.2, 0)});
  play(backend, walk.keyframes[0], 0);
  const SE3& T = backend.graph().keyframes.at(KeyframeId{0}).T_map_body;
  EXPECT_EQ(T.translation, Eigen::Vector3d(Eigen::Vector3d::Zero()));
  EXPECT_LT((T.rotation * walk.keyframes[0].up_body - Eigen::Vector3d::UnitZ()).norm(), 1e-9);
  EXPECT_NEAR((T.rotation * Eigen::Vector3d::UnitX()).y(), 0.0, 1e-9);
}

TEST(BackendTest, MapToOdomTakesTheNewestOdomPoseToItsMapPose) {
  Backend backend{BackendConfig{}};
  const Walk walk = makeWalk({.num_keyframes = 40});
  const RoundOutput output = playAll(backend, walk);
  const KeyframeNode& newest = backend.graph().keyframes.rbegin()->second;
  EXPECT_LT(distance(output.T_map_odom * newest.T_odom_body, newest.T_map_body), 1e-9);
}

TEST(BackendTest, NothingTiltsWithoutAnUpMeasurement) {
  Backend backend{BackendConfig{}};
  playAll(backend, makeWalk({.num_keyframes = 10}));
  EXPECT_EQ(backend.graph().up_map, Eigen::Vector3d(Eigen::Vector3d::UnitZ()));
  EXPECT_EQ(distance(backend.graph().keyframes.at(KeyframeId{0}).T_map_body, SE3()), 0.0);
}

// The first keyframe's own up is 20 mrad off; the next ones know better. Before round 3 the whole map turns.
TEST(BackendTest, MapIsLevelledAgainOnceBeforeRoundThree) {
  Walk walk = makeWalk({.num_keyframes = 12, .up_sigma_rad = 1e-3, .sigma_m = 1e-4, .sigma_rad = 1e-4});
  walk.keyframes[0].up_body = so3Exp({0.02, 0, 0}) * walk.keyframes[0].up_body;
  walk.keyframes[0].up_sigma_rad = 0.02;
  Backend backend{BackendConfig{}};
  SE3 first;
  for (int64_t round = 0; round < 12; ++round) {
    const RoundOutput output = play(backend, walk.keyframes[static_cast<size_t>(round)], round);
    const SE3 now = backend.graph().keyframes.at(KeyframeId{0}).T_map_body;
    if (round == 3) {
      EXPECT_GT(distance(first, now), 0.01);
      EXPECT_THAT(output.changed, Contains(KeyframeId{0}));
      const Eigen::Vector3d up_truth =
          now.rotation * walk.truth[0].rotation.conjugate() * Eigen::Vector3d::UnitZ();
      EXPECT_LT((up_truth - Eigen::Vector3d::UnitZ()).norm(), 3e-3);
      EXPECT_NEAR((now.rotation * Eigen::Vector3d::UnitX()).y(), 0.0, 1e-9) << "the heading stays";
    } else if (round > 0) {
      EXPECT_EQ(distance(first, now), 0.0) << "round " << round;
    }
    first = now;
  }
}

TEST(BackendTest, LevellingAgainChangesNoResidual) {
  const Walk walk = makeWalk({.num_keyframes = 3, .up_sigma_rad = 0.02});
  Backend backend{BackendConfig{}};
  playAll(backend, walk);
  play(backend, std::nullopt, 2);
  const auto before = backend.factorStatistics();
  const Eigen::Vector3d up_before = backend.graph().up_map;
  play(backend, std::nullopt, 3);
  EXPECT_GT((up_before - Eigen::Vector3d::UnitZ()).norm(), 1e-4);
  EXPECT_LT((backend.graph().up_map - Eigen::Vector3d::UnitZ()).norm(), 1e-12);
  for (const auto& [kind, statistics] : backend.factorStatistics())
    EXPECT_NEAR(statistics.chi2, before.at(kind).chi2, 1e-6) << kind;
}

TEST(BackendTest, SameInputsGiveTheSameDigestInEveryRound) {
  const Walk walk = makeWalk({.num_keyframes = 120, .loop_every = 25, .up_sigma_rad = 0.01});
  Backend a{BackendConfig{}};
  std::vector<std::string> digests;
  for (size_t k = 0; k < walk.keyframes.size(); ++k)
    digests.push_back(play(a, walk.keyframes[k], static_cast<int64_t>(k)).graph_digest);
  // Other addresses of the same states must not matter.
  std::vector<std::unique_ptr<std::array<char, 777>>> clutter;
  Backend b{BackendConfig{}};
  for (size_t k = 0; k < walk.keyframes.size(); ++k) {
    clutter.push_back(std::make_unique<std::array<char, 777>>());
    if (k % 3 == 0) clutter.erase(clutter.begin());
    ASSERT_EQ(play(b, walk.keyframes[k], static_cast<int64_t>(k)).graph_digest, digests[k]) << k;
  }
}

TEST(BackendTest, LostKeyframeIsBridgedByOdometryAndSaidSo) {
  const Walk walk = makeWalk({.num_keyframes = 30, .neighbours = false});
  Backend backend{BackendConfig{}};
  for (int k = 0; k < 30; ++k) {
    if (k == 10 || k == 11) continue;
    const RoundOutput output = play(backend, walk.keyframes[static_cast<size_t>(k)], k);
    EXPECT_EQ(output.bridged, k == 12);
    if (k != 12) continue;
    EXPECT_THAT(output.refused, ElementsAre(HasSubstr("k11, which is not in the graph")));
    EXPECT_GT(output.keyframe_covariance(0, 0), 0.1 * 0.1) << "the bridge is wide";
  }
  const SituationalGraph& graph = backend.graph();
  graph.check();
  EXPECT_EQ(graph.keyframes.size(), 28U);
  const SE3 truth = walk.truth[9].inverse() * walk.truth[12];
  const SE3 estimate =
      graph.keyframes.at(KeyframeId{9}).T_map_body.inverse() * graph.keyframes.at(KeyframeId{12}).T_map_body;
  EXPECT_LT(distance(truth, estimate), 0.1);
}

// The first keyframe of another session is tied to where the robot was found, not to where the map ended.
TEST(BackendTest, AKeyframeMeasuredFromElsewhereIsPlacedThereAndOnThatStorey) {
  Backend backend{BackendConfig{}};
  Walk walk = makeWalk({.num_keyframes = 20});
  Keyframe found = walk.keyframes.back();
  walk.keyframes.pop_back();
  playAll(backend, walk);
  Rooms rooms;
  rooms.round = 18;
  for (const int64_t floor : {0, 1}) rooms.floors.emplace_back().id = FloorId{floor};
  rooms.keyframe_floors = {{KeyframeId{4}, FloorId{1}}};
  backend.step({.round = 19, .time = Time{20'000'000}, .keyframe = {}, .rooms = rooms});
  RelativePose z;
  z.kind = RelativePoseKind::kNeighbour;
  z.from = KeyframeId{4};
  z.to = found.id;
  z.T_from_to = {so3Exp({0, 0, 2.4}), {0.3, -0.2, 0}};
  z.covariance = 1e-4 * Matrix6d::Identity();
  found.relative_poses = {z};
  const RoundOutput output = play(backend, found, 20);
  EXPECT_FALSE(output.bridged);
  const auto& keyframes = backend.graph().keyframes;
  EXPECT_LT(distance(keyframes.at(found.id).T_map_body, keyframes.at(z.from).T_map_body * z.T_from_to), 1e-6);
  EXPECT_EQ(keyframes.at(found.id).floor, FloorId{1});
  // Known from there, and no worse for the way to where the map ended.
  EXPECT_LT(keyframes.at(found.id).covariance.trace(), keyframes.at(KeyframeId{4}).covariance.trace() + 7e-4);
}

TEST(BackendTest, RefusedKeyframesLeaveTheGraphAsItWas) {
  const Walk walk = makeWalk({.num_keyframes = 6});
  Backend backend{BackendConfig{}};
  const RoundOutput last = playAll(backend, walk);
  play(backend, std::nullopt, 6);
  const std::string digest = backend.graph().digest();
  Keyframe poisoned = walk.keyframes[5];
  poisoned.id = KeyframeId{6};
  poisoned.T_odom_body.translation.x() = std::numeric_limits<double>::quiet_NaN();
  for (const Keyframe& keyframe : {walk.keyframes[5], walk.keyframes[2], poisoned}) {
    const RoundOutput output = play(backend, keyframe, 7);
    EXPECT_EQ(output.refused.size(), 1U);
    EXPECT_EQ(output.graph_digest, digest);
    EXPECT_TRUE(output.changed.empty());
  }
}

TEST(BackendTest, RoundsBeforeTheFirstKeyframeAreEmpty) {
  Backend backend{BackendConfig{}};
  const RoundOutput output = play(backend, std::nullopt, 0);
  EXPECT_TRUE(output.changed.empty());
  EXPECT_EQ(output.graph_digest, SituationalGraph().digest());
}

// A loop of 40 m that no odometry supports: the walk stays where it was.
TEST(BackendTest, FalseLoopDoesNotBendTheWalk) {
  Walk walk = makeWalk({.num_keyframes = 60});
  Backend clean{BackendConfig{}};
  playAll(clean, walk);
  play(clean, std::nullopt, 60);
  RelativePose z = walk.keyframes[50].relative_poses[0];
  z.kind = RelativePoseKind::kLoop;
  z.from = KeyframeId{0};
  z.T_from_to = walk.truth[0].inverse() * walk.truth[50];
  z.T_from_to.translation.x() += 40;
  walk.keyframes[50].relative_poses.push_back(z);
  Backend misled{BackendConfig{}};
  playAll(misled, walk);
  for (int round = 60; round < 65; ++round) play(misled, std::nullopt, round);
  for (const auto& [id, node] : clean.graph().keyframes)
    EXPECT_LT(distance(node.T_map_body, misled.graph().keyframes.at(id).T_map_body), 0.05) << id.str();
}

}  // namespace
}  // namespace sgraphs
