// The backend and its loops, on a ring of corridors whose odometry drifts by metres.
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <cmath>

#include "backend/backend.h"
#include "backend/loops/odometry_chain.h"
#include "tests/backend/loops/drift_ring.h"

namespace sgraphs {
namespace {

using testing_support::DriftRing;
using testing_support::makeDriftRing;

const DriftRing& ring() {
  static const DriftRing kRing = makeDriftRing({});
  return kRing;
}

// The first lap ends at keyframe 200.
constexpr size_t kReturn = 212;

struct LoopRun {
  Backend backend{BackendConfig{}};
  int64_t round = 0;
  RoundOutput newest = {};
  std::vector<std::string> refused = {};

  const SituationalGraph& graph() const { return backend.graph(); }

  void step(RoundInput input) {
    input.round = round++;
    newest = backend.step(std::move(input));
    refused.insert(refused.end(), newest.refused.begin(), newest.refused.end());
  }
  void keyframe(size_t k, std::optional<LoopClosures> loops = {}) {
    step({.time = ring().keyframes[k].time,
          .keyframe = ring().keyframes[k],
          .planes = ring().planes[k],
          .loops = std::move(loops)});
  }
  void idle(std::optional<LoopClosures> loops = {}) {
    step({.time = ring().keyframes.back().time, .keyframe = {}, .loops = std::move(loops)});
  }
  void until(size_t end) {
    for (size_t k = graph().keyframes.size(); k < end; ++k) keyframe(k);
  }
  // The walk from here to its end with true loops from some keyframes, and what is left to do.
  void withTrueLoops(int64_t first_id, size_t first_keyframe) {
    for (size_t k = graph().keyframes.size(); k < ring().keyframes.size(); ++k) {
      const bool again = k > first_keyframe && k % 4 == 0;
      keyframe(k, again ? loops({ring().loop(KeyframeId{static_cast<int64_t>(k) - 1}, LoopId{first_id++})})
                        : std::nullopt);
    }
    for (int i = 0; i < 4; ++i) idle();
    graph().check();
  }

  static std::optional<LoopClosures> loops(std::vector<LoopClosure> accepted,
                                           std::vector<LoopId> withdrawn = {}) {
    LoopClosures all;
    all.accepted = std::move(accepted);
    all.withdrawn = std::move(withdrawn);
    return all;
  }
  int64_t active() const { return backend.factorStatistics().at("loop").count; }
  double offAtTheEnd_m() const {
    const SE3 truth = ring().T_map_world() * ring().truth[graph().keyframes.size() - 1];
    return (graph().keyframes.rbegin()->second.T_map_body.translation - truth.translation).norm();
  }
  double ate_m() const {
    Eigen::Matrix3Xd estimated(3, graph().keyframes.size()), truth(3, graph().keyframes.size());
    for (const auto& [id, node] : graph().keyframes) {
      estimated.col(id.value) = node.T_map_body.translation;
      truth.col(id.value) = ring().truth[static_cast<size_t>(id.value)].translation;
    }
    const Eigen::Isometry3d aligned(Eigen::umeyama(estimated, truth, false));
    return std::sqrt((aligned * estimated - truth).colwise().squaredNorm().mean());
  }
  // Pairs of planes that are one face.
  std::vector<std::string> doubled() const {
    std::vector<std::string> found;
    for (const auto& [i, a] : graph().planes)
      for (const auto& [j, b] : graph().planes) {
        if (j <= i || a.normal_map.dot(b.normal_map) < 0.98) continue;
        const Polygon2d own = extentOf(a), other = extentOn(a, b);
        if (overlapArea(own, other) < 0.2 * std::min(polygonArea(own), polygonArea(other))) continue;
        if (std::abs(a.distance(b.centroid_map)) < 0.3) found.push_back(i.str() + " " + j.str());
      }
    return found;
  }
};

// A loop that is off by this on the side of `to`.
LoopClosure offBy(LoopClosure loop, const Eigen::Vector3d& by_m) {
  loop.pose.T_from_to.translation += by_m;
  return loop;
}

// Mistake 5 of earlier systems: loops that mend less than the drift. And mistake 10: loops that do not reach
// the solver.
TEST(BackendLoopsTest, ALoopMendsMetresOfDriftAndNoWallStaysDoubled) {
  LoopRun run;
  run.until(kReturn + 10);
  EXPECT_GT(run.offAtTheEnd_m(), 5.0);
  const size_t planes_before = run.graph().planes.size();
  run.withTrueLoops(0, kReturn + 10);
  EXPECT_LT(run.ate_m(), 0.05);
  for (const std::string& pair : run.doubled()) ADD_FAILURE() << "doubled: " << pair;
  EXPECT_LT(run.graph().planes.size(), planes_before) << "walls of the second lap were mapped twice";
  EXPECT_TRUE(run.refused.empty());
  EXPECT_GT(run.active(), 3);
  EXPECT_EQ(run.active(), static_cast<int64_t>(run.graph().loops.size()));
  const FactorStatistics loops = run.backend.factorStatistics().at("loop");
  EXPECT_EQ(loops.dof, 6 * loops.count);
  EXPECT_GT(loops.chi2, 0);
  EXPECT_LT(loops.chi2, 2.0 * static_cast<double>(loops.dof));
}

// What the walls were taken for under the drift must not hold the map bent: one loop does it.
TEST(BackendLoopsTest, OneLoopIsEnough) {
  LoopRun run;
  run.until(kReturn + 10);
  run.keyframe(kReturn + 10, LoopRun::loops({ring().loop(KeyframeId{215}, LoopId{0})}));
  EXPECT_TRUE(run.newest.whole_graph);
  EXPECT_LT(run.ate_m(), 0.1);
  EXPECT_GT(run.newest.changed.size(), 100u) << "those that moved are announced";
  for (int i = 0; i < 4; ++i) run.idle();
  EXPECT_LT(run.ate_m(), 0.05);
  for (const std::string& pair : run.doubled()) ADD_FAILURE() << "doubled: " << pair;
}

TEST(BackendLoopsTest, OdometryContradictsALoopToASimilarPlaceNearBy) {
  LoopRun run, without;
  run.until(80);
  without.until(80);
  LoopClosure wrong = ring().loop(KeyframeId{79}, LoopId{0});
  wrong.pose.from = KeyframeId{74};  // 4 m back, and it looks the same
  run.keyframe(80, LoopRun::loops({wrong}));
  without.keyframe(80);
  EXPECT_EQ(run.active(), 0);
  EXPECT_EQ(run.graph().loops.size(), 1u) << "it is known all the same";
  ASSERT_EQ(run.refused.size(), 1u);
  EXPECT_NE(run.refused[0].find("odometry contradicts it"), std::string::npos) << run.refused[0];
  EXPECT_LT((run.newest.T_map_odom.translation - without.newest.T_map_odom.translation).norm(), 1e-6);
  EXPECT_NE(run.newest.graph_digest, without.newest.graph_digest);
}

// A bias adds up along the way, chance by the root of it: 290 steps of a legged robot were 27 sigma off by
// chance.
TEST(BackendLoopsTest, TheWayIsAsUncertainAsABiasMakesIt) {
  OdometryChain chain;
  RelativePose z;
  z.covariance = 4e-6 * Matrix6d::Identity();
  z.T_from_to.translation.x() = 1;
  const SE3 off(so3Exp({0, 0, 0.002}), {0.002, 0, 0});  // one sigma, of one sign
  SE3 truth;
  for (int64_t k = 1; k <= 30; ++k) {
    z.from = KeyframeId{k - 1};
    z.to = KeyframeId{k};
    chain.add(z);
    truth = truth * z.T_from_to * off;
  }
  const auto way = chain.between(KeyframeId{0}, KeyframeId{30}),
             back = chain.between(KeyframeId{30}, KeyframeId{0});
  ASSERT_TRUE(way && back);
  EXPECT_LT((back->T_from_to * way->T_from_to).translation.norm(), 1e-9);
  const Vector6d r = se3Log(way->T_from_to.inverse() * truth);
  EXPECT_LT(r.dot(way->covariance.ldlt().solve(r)), 3.0) << "two errors of a sigma each";
  EXPECT_FALSE(chain.between(KeyframeId{0}, KeyframeId{31}));
}

// Within the drift nothing speaks against the first; those that follow do, and the map comes back.
TEST(BackendLoopsTest, AFalseLoopIsSwitchedOffWhenOthersContradictIt) {
  LoopRun run;
  run.until(kReturn);
  run.keyframe(kReturn, LoopRun::loops({offBy(ring().loop(KeyframeId{210}, LoopId{0}), {2.0, 0.0, 0})}));
  EXPECT_EQ(run.active(), 1);
  EXPECT_GT(run.offAtTheEnd_m(), 1.0);
  run.withTrueLoops(1, kReturn);
  EXPECT_FALSE(run.graph().loops.at(LoopId{0}).active());
  EXPECT_EQ(run.active(), static_cast<int64_t>(run.graph().loops.size()) - 1);
  EXPECT_LT(run.ate_m(), 0.05);
  for (const std::string& pair : run.doubled()) ADD_FAILURE() << "doubled: " << pair;
}

TEST(BackendLoopsTest, AWithdrawnLoopLeavesTheMapAsItWas) {
  LoopRun run, without;
  run.until(kReturn);
  without.until(kReturn + 1);
  run.keyframe(kReturn, LoopRun::loops({ring().loop(KeyframeId{210}, LoopId{0})}));
  EXPECT_LT(run.ate_m(), 0.1);
  run.idle(LoopRun::loops({}, {LoopId{0}}));
  EXPECT_EQ(run.active(), 0);
  EXPECT_TRUE(run.graph().loops.empty());
  run.idle();
  without.idle();
  EXPECT_NEAR(run.offAtTheEnd_m(), without.offAtTheEnd_m(), 0.1);
  EXPECT_NEAR(run.ate_m(), without.ate_m(), 0.05);
  EXPECT_TRUE(run.refused.empty());
}

TEST(BackendLoopsTest, ALoopThatAgreesLaterComesBack) {
  LoopRun run;
  run.until(kReturn);
  const LoopClosure loop = ring().loop(KeyframeId{210}, LoopId{1});
  run.keyframe(kReturn, LoopRun::loops({offBy(ring().loop(KeyframeId{209}, LoopId{0}), {2.0, 0, 0}), loop}));
  EXPECT_LT(run.active(), 2) << "they contradict each other";
  run.withTrueLoops(2, kReturn);
  EXPECT_TRUE(run.graph().loops.at(LoopId{1}).active());
  EXPECT_FALSE(run.graph().loops.at(LoopId{0}).active());
}

TEST(BackendLoopsTest, WhatCannotBeIsNamedAndLeftOut) {
  LoopRun run;
  run.until(30);
  const auto base = [&](int64_t id) {
    LoopClosure loop = ring().loop(KeyframeId{29}, LoopId{id});
    loop.pose.from = KeyframeId{28};
    loop.pose.T_from_to = ring().truth[28].inverse() * ring().truth[29];
    return loop;
  };
  std::vector<LoopClosure> bad(6, base(0));
  bad[0].id = LoopId{};
  bad[1].pose.to = KeyframeId{777};
  bad[2].pose.from = bad[2].pose.to;
  bad[3].pose.T_from_to.translation.x() = std::nan("");
  bad[4].pose.covariance.setZero();
  bad[5].pose.kind = RelativePoseKind::kOdometry;
  for (size_t i = 1; i < bad.size(); ++i) bad[i].id = LoopId{static_cast<int64_t>(i)};
  run.idle(LoopRun::loops(bad, {LoopId{99}}));
  EXPECT_EQ(run.refused.size(), bad.size() + 1);
  EXPECT_TRUE(run.graph().loops.empty());
  run.idle(LoopRun::loops({base(3)}));
  EXPECT_EQ(run.refused.size(), bad.size() + 2) << "an id is not used twice";
  run.idle(LoopRun::loops({base(6)}));
  EXPECT_EQ(run.active(), 1);
  run.graph().check();
}

TEST(BackendLoopsTest, TheSameInputGivesTheSameDigest) {
  std::string digests[2];
  for (std::string& digest : digests) {
    LoopRun run;
    run.until(kReturn);
    run.keyframe(kReturn, LoopRun::loops({ring().loop(KeyframeId{210}, LoopId{0})}));
    for (int i = 0; i < 2; ++i) run.idle();
    digest = run.newest.graph_digest;
  }
  EXPECT_EQ(digests[0], digests[1]);
}

}  // namespace
}  // namespace sgraphs
