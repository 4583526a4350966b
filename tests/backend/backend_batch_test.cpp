// The backend's rounds against a batch solution made from its graph by plain Ceres.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "backend/backend.h"
#include "tests/backend/batch_reference.h"
#include "tests/backend/synthetic_walk.h"

namespace sgraphs {
namespace {

using testing_support::batchCovariance;
using testing_support::BatchResult;
using testing_support::makeWalk;
using testing_support::solveBatch;
using testing_support::Walk;
using testing_support::WalkOptions;

constexpr double kLoopCauchyScale = 10.0;  // as the backend's

struct Tolerance {
  double m;
  double rad;
  double chi2_per_dof;
};
constexpr Tolerance kAfterTheLastRound{2e-3, 2e-4, 1e-3};
// Between whole-graph solves: well below the standard deviations of the poses.
constexpr Tolerance kUnderWay{1e-2, 4e-4, 1e-3};

void expectOptimum(const SituationalGraph& graph, const Tolerance& tolerance) {
  double cost = 0;
  const BatchResult batch = solveBatch(graph, kLoopCauchyScale, &cost);
  for (const auto& [id, node] : graph.keyframes) {
    const SE3& optimum = batch.T_map_body.at(id);
    ASSERT_LT((node.T_map_body.translation - optimum.translation).norm(), tolerance.m) << id.str();
    ASSERT_LT(node.T_map_body.rotation.angularDistance(optimum.rotation), tolerance.rad) << id.str();
  }
  const double dof = batch.residuals - batch.free_dof;
  EXPECT_LT(2.0 * (cost - batch.cost) / dof, tolerance.chi2_per_dof);
}

struct Case {
  const char* name;
  WalkOptions walk;
};

class BackendBatchTest : public testing::TestWithParam<Case> {};

// Rounds with keyframes stay close; the idle rounds at the end of a run bring the optimum of the whole.
TEST_P(BackendBatchTest, RoundsEndAtTheBatchOptimum) {
  const Walk walk = makeWalk(GetParam().walk);
  Backend backend{BackendConfig{}};
  int64_t round = 0;
  int whole_rounds = 0;
  for (const Keyframe& keyframe : walk.keyframes)
    whole_rounds += backend.step({.round = round++, .time = keyframe.time, .keyframe = keyframe}).whole_graph;
  backend.graph().check();
  expectOptimum(backend.graph(), kUnderWay);
  RecordProperty("whole_rounds", whole_rounds);
  backend.step({.round = round++, .time = walk.keyframes.back().time, .keyframe = {}});
  expectOptimum(backend.graph(), kAfterTheLastRound);
}

// Every factor that was put in shows its residual, and they add up to what the batch sees: none is created
// without reaching the solver. Weights that describe the noise give chi2 near its degrees of freedom.
TEST_P(BackendBatchTest, EveryFactorReachesTheSolverAtItsWeight) {
  const Walk walk = makeWalk(GetParam().walk);
  Backend backend{BackendConfig{}};
  std::map<std::string, int64_t> expected{
      {"odometry", 0},   {"neighbour", 0},  {"loop", 0},         {"up", 0},        {"observes", 0},
      {"plane_up", 0},   {"faces", 0},      {"same_height", 0},  {"room_wall", 0}, {"room_wall_infinite", 0},
      {"room_shape", 0}, {"floor_wall", 0}, {"floor_height", 0}, {"floor_room", 0}};
  int64_t round = 0;
  for (const Keyframe& keyframe : walk.keyframes) {
    for (const RelativePose& z : keyframe.relative_poses)
      ++expected[std::array{"odometry", "neighbour", "loop"}[static_cast<size_t>(z.kind)]];
    expected["up"] += keyframe.up_sigma_rad > 0;
    backend.step({.round = round++, .time = keyframe.time, .keyframe = keyframe});
  }
  backend.step({.round = round++, .time = Time{}, .keyframe = {}});
  double chi2 = 0;
  int64_t residuals = 0;
  for (const auto& [kind, statistics] : backend.factorStatistics()) {
    EXPECT_EQ(statistics.count, expected.at(kind)) << kind;
    EXPECT_EQ(statistics.dof, (kind == "up" ? 2 : 6) * statistics.count) << kind;
    if (kind == "up" || kind == "loop" || kind == "neighbour") {
      EXPECT_EQ(statistics.chi2 > 0, statistics.count > 0) << kind;
    }
    chi2 += statistics.chi2;
    residuals += statistics.dof;
  }
  const BatchResult batch = solveBatch(backend.graph(), kLoopCauchyScale);
  EXPECT_EQ(residuals, batch.residuals);
  const int64_t states = 6 * (static_cast<int64_t>(walk.keyframes.size()) - 1) + (expected["up"] > 0 ? 2 : 0);
  EXPECT_EQ(batch.free_dof, states);
  EXPECT_NEAR(chi2 / static_cast<double>(residuals - states), 1.0, 0.2);
}

INSTANTIATE_TEST_SUITE_P(Walks, BackendBatchTest,
                         testing::Values(Case{"Chain", {.num_keyframes = 300}},
                                         Case{"Loops", {.num_keyframes = 400, .seed = 2, .loop_every = 60}},
                                         Case{"ManyLoops",
                                              {.num_keyframes = 200, .seed = 3, .loop_every = 7}},
                                         Case{"Up", {.num_keyframes = 250, .seed = 4, .up_sigma_rad = 0.01}},
                                         Case{"LoopsAndUp",
                                              {.num_keyframes = 300,
                                               .seed = 5,
                                               .loop_every = 80,
                                               .up_sigma_rad = 0.005,
                                               .start_tilt = Eigen::Vector3d(0.2, 0.1, 0)}}),
                         [](const auto& param_info) { return param_info.param.name; });

// Drift of metres before the loop comes: the robust loss must not take the first true loop for a false one.
TEST(BackendDriftTest, TrueLoopAfterMetresOfDriftCloses) {
  WalkOptions options{.num_keyframes = 200, .seed = 6, .neighbours = false};
  options.sigma_rad = 0.02;
  Walk walk = makeWalk(options);
  RelativePose loop = walk.keyframes[199].relative_poses[0];
  loop.kind = RelativePoseKind::kLoop;
  loop.from = KeyframeId{0};
  loop.T_from_to = walk.truth[0].inverse() * walk.truth[199];
  Backend backend{BackendConfig{}};
  int64_t round = 0;
  for (const Keyframe& keyframe : walk.keyframes) {
    if (keyframe.id.value == 199) {
      const SE3 before = backend.graph().keyframes.rbegin()->second.T_map_body;
      ASSERT_GT(
          (walk.truth[0].inverse() * walk.truth[198] * Eigen::Vector3d::Zero() - before.translation).norm(),
          2.0);
      walk.keyframes[199].relative_poses.push_back(loop);
    }
    backend.step({.round = round++, .time = keyframe.time, .keyframe = keyframe});
  }
  for (int i = 0; i < 4; ++i) backend.step({.round = round++, .time = Time{}, .keyframe = {}});
  const SE3& last = backend.graph().keyframes.at(KeyframeId{199}).T_map_body;
  EXPECT_LT((last.translation - loop.T_from_to.translation).norm(), 0.1);
}

double smallestEigenvalue(const Matrix6d& m) {
  return Eigen::SelfAdjointEigenSolver<Matrix6d>(m, Eigen::EigenvaluesOnly).eigenvalues()(0);
}

// Never below the marginal covariance of the whole graph, in no direction and in no round.
TEST_P(BackendBatchTest, CovarianceOfTheNewestKeyframeIsConservative) {
  WalkOptions options = GetParam().walk;
  options.num_keyframes = 55;
  if (options.loop_every > 25) options.loop_every = 25;
  const Walk walk = makeWalk(options);
  Backend backend{BackendConfig{}};
  int64_t round = 0;
  for (const Keyframe& keyframe : walk.keyframes) {
    const RoundOutput output = backend.step({.round = round++, .time = keyframe.time, .keyframe = keyframe});
    if (round % 6 != 0) continue;
    Matrix6d marginal;
    ASSERT_TRUE(batchCovariance(backend.graph(), kLoopCauchyScale, keyframe.id, marginal)) << "free gauge";
    EXPECT_GT(smallestEigenvalue(output.keyframe_covariance - marginal), 0.0) << "round " << round - 1;
    EXPECT_LT(output.keyframe_covariance.trace(), 50.0 * marginal.trace()) << "useless bound";
  }
}

}  // namespace
}  // namespace sgraphs
