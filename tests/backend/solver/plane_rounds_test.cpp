// Rounds with planes against the optimum that plain Ceres finds from the same factors.
#include <gtest/gtest.h>

#include <algorithm>
#include <ostream>
#include <string>

#include "tests/backend/solver/plane_world.h"

namespace sgraphs {
namespace {

using testing_support::makePlaneWorld;
using testing_support::PlaneRun;
using testing_support::PlaneWorld;
using testing_support::PlaneWorldOptions;

struct Case {
  const char* name;
  PlaneWorldOptions world;
};
void PrintTo(const Case& c, std::ostream* out) {
  *out << c.name;
}

class PlaneRoundsTest : public testing::TestWithParam<Case> {};

TEST_P(PlaneRoundsTest, StayCloseAndEndAtTheBatchOptimum) {
  const PlaneWorld world = makePlaneWorld(GetParam().world);
  PlaneRun run(world, {});
  const int n = world.options.num_keyframes;
  int whole = 0;
  PlaneRun::Distance worst;
  for (int k = 0; k < n; ++k) {
    run.addRound(k);
    const IncrementalSolver::Report report = run.solver().solve(false);
    whole += report.whole;
    if (report.whole || k % 23 != 0) continue;
    const PlaneRun::Distance distance = run.distanceFromBatch();
    worst.m = std::max(worst.m, distance.m);
    worst.rad = std::max(worst.rad, distance.rad);
    worst.chi2_per_dof = std::max(worst.chi2_per_dof, distance.chi2_per_dof);
  }
  RecordProperty("whole_rounds", whole);
  RecordProperty("worst_mm", std::to_string(1e3 * worst.m));
  RecordProperty("worst_mrad", std::to_string(1e3 * worst.rad));
  EXPECT_LT(whole, n / 2) << "most rounds are local";
  EXPECT_LT(worst.m, 1e-2);
  EXPECT_LT(worst.rad, 4e-4);
  EXPECT_LT(worst.chi2_per_dof, 1e-3);

  run.solver().solve(true);
  ASSERT_TRUE(run.solver().settled());
  const PlaneRun::Distance end = run.distanceFromBatch();
  EXPECT_LT(end.m, 2e-3);
  EXPECT_LT(end.rad, 2e-4);
  EXPECT_LT(end.plane_m, 2e-3);
  EXPECT_LT(end.plane_rad, 2e-4);
  EXPECT_LT(end.chi2_per_dof, 1e-3);
  EXPECT_NEAR(end.batch_chi2_per_dof, 1.0, 0.1) << "weights that describe the noise";
}

INSTANTIATE_TEST_SUITE_P(
    Worlds, PlaneRoundsTest,
    testing::Values(Case{"FreshWalls", {.num_keyframes = 150, .per_lap = 200}},
                    Case{"OldWallsSeenAgain", {.num_keyframes = 250, .seed = 2}},
                    Case{"OldWallsAndLoops",
                         {.num_keyframes = 200, .per_lap = 80, .relative_loop_every = 20, .seed = 3}},
                    Case{"WallsAlone",
                         {.num_keyframes = 150,
                          .per_lap = 60,
                          .num_planes = 50,
                          .seen_per_keyframe = 6,
                          .structure = false,
                          .seed = 4}}),
    [](const auto& param_info) { return param_info.param.name; });

}  // namespace
}  // namespace sgraphs
