#include "backend/solver/incremental_solver.h"

#include <gtest/gtest.h>

#include "backend/factors/relative_pose_cost.h"
#include "backend/factors/up_cost.h"

namespace sgraphs {
namespace {

SE3 along(double x) {
  return {Eigen::Quaterniond::Identity(), Eigen::Vector3d(x, 0, 0)};
}

Matrix6d isotropic(double sigma) {
  return sigma * sigma * Matrix6d::Identity();
}

void join(IncrementalSolver& solver, int i, int j, const SE3& Z, double sigma,
          std::optional<double> cauchy_scale = {}) {
  solver.addFactor(RelativePoseCost::Create(Z, isotropic(sigma)), {i, j}, cauchy_scale);
}

TEST(IncrementalSolverTest, OneMeasurementIsMetExactly) {
  IncrementalSolver solver({});
  solver.hold(solver.addPose(SE3()));
  const SE3 Z = se3Exp((Vector6d() << 1, 2, -1, 0.4, -0.3, 0.8).finished());
  join(solver, 0, solver.addPose(SE3()), Z, 0.1);
  const IncrementalSolver::Report report = solver.solve(true);
  EXPECT_TRUE(report.converged);
  EXPECT_LT(se3Log(Z.inverse() * solver.pose(1)).norm(), 1e-8);
  EXPECT_TRUE(solver.settled());
}

// Three steps of 1 m and a loop that says 3.3 m, all at the same sigma: the 0.3 m are shared by four factors,
// 75 mm each.
TEST(IncrementalSolverTest, LoopSharesItsErrorByWeight) {
  IncrementalSolver solver({});
  solver.hold(solver.addPose(SE3()));
  for (int k = 1; k <= 3; ++k) {
    solver.addPose(along(k));
    join(solver, k - 1, k, along(1), 0.1);
  }
  join(solver, 0, 3, along(3.3), 0.1);
  solver.solve(true);
  for (int k = 1; k <= 3; ++k) EXPECT_NEAR(solver.pose(k).translation.x(), 1.075 * k, 1e-7);
  double chi2 = 0;
  for (int f = 0; f < 4; ++f) chi2 += solver.chi2(f);
  EXPECT_NEAR(chi2, 4 * 0.75 * 0.75, 1e-6);
}

// Two measurements of 1 m (sigma 0.1) and 1.5 m (sigma 0.2): weights 100 and 25, mean 1.1.
TEST(IncrementalSolverTest, MeasurementsAreWeighedByTheirInformation) {
  IncrementalSolver solver({});
  solver.hold(solver.addPose(SE3()));
  solver.addPose(SE3());
  join(solver, 0, 1, along(1.0), 0.1);
  join(solver, 0, 1, along(1.5), 0.2);
  solver.solve(true);
  EXPECT_NEAR(solver.pose(1).translation.x(), 1.1, 1e-7);
}

TEST(IncrementalSolverTest, HeldStateStaysToTheLastBit) {
  IncrementalSolver solver({});
  const SE3 start = se3Exp((Vector6d() << 0.1, 0.2, 0.3, 0.4, 0.5, 0.6).finished());
  solver.hold(solver.addPose(start));
  join(solver, 0, solver.addPose(SE3()), along(1), 0.1);
  join(solver, 0, 1, along(2), 0.1);
  solver.solve(true);
  EXPECT_EQ(solver.pose(0).translation, start.translation);
  EXPECT_EQ(solver.pose(0).rotation.coeffs(), start.rotation.coeffs());
}

// A false loop of 40 m over a chain of centimetres: with a robust loss the chain stays within millimetres.
TEST(IncrementalSolverTest, RobustLossKeepsAFalseLoopFromBendingTheChain) {
  IncrementalSolver solver({});
  solver.hold(solver.addPose(SE3()));
  for (int k = 1; k <= 5; ++k) {
    solver.addPose(along(k));
    join(solver, k - 1, k, along(1), 0.01);
  }
  join(solver, 0, 5, along(45), 0.01, 4.1);
  solver.solve(true);
  EXPECT_NEAR(solver.pose(5).translation.x(), 5.0, 5e-3);
}

// By hand: a chain adds variances, 2 * 0.1^2; a third measurement across at sigma 0.1 makes
// 1/(1/0.02+1/0.01).
TEST(IncrementalSolverTest, CovarianceOfAPureTranslationChain) {
  IncrementalSolver solver({});
  solver.hold(solver.addPose(SE3()));
  for (int k = 1; k <= 2; ++k) {
    solver.addPose(along(k));
    join(solver, k - 1, k, along(1), 0.1);
  }
  solver.solve(true);
  ASSERT_TRUE(solver.covariance(2));
  EXPECT_NEAR((*solver.covariance(2))(0, 0), 0.02, 1e-9);
  // The heading of the first step (0.1 rad at 1 m) shows sideways.
  EXPECT_NEAR((*solver.covariance(2))(1, 1), 0.02 + 0.01, 1e-9);
  join(solver, 0, 2, along(2), 0.1);
  solver.solve(true);
  EXPECT_NEAR((*solver.covariance(2))(0, 0), 1.0 / (1.0 / 0.02 + 1.0 / 0.01), 1e-6);
  EXPECT_EQ(*solver.covariance(0), Matrix6d(Matrix6d::Zero()));
}

TEST(IncrementalSolverTest, FreeGaugeIsNotedNotInvented) {
  IncrementalSolver solver({});
  solver.addPose(SE3());  // not held
  join(solver, 0, solver.addPose(along(1)), along(1), 0.1);
  solver.solve(true);
  EXPECT_FALSE(solver.covariance(1));
}

// A chain of 200 that only its end was added to: the round frees a few states at that end.
TEST(IncrementalSolverTest, RoundAtTheEndOfAChainIsLocal) {
  IncrementalSolver solver({});
  solver.hold(solver.addPose(SE3()));
  for (int k = 1; k <= 200; ++k) {
    solver.addPose(along(k));
    join(solver, k - 1, k, along(1), 0.01);
    if (k >= 2) join(solver, k - 2, k, along(2.004), 0.01);
    const IncrementalSolver::Report report = solver.solve(false);
    if (k <= 40 || report.whole) continue;
    ASSERT_FALSE(report.free.empty());
    EXPECT_EQ(report.free.back(), k);
    EXPECT_GT(report.free.front(), k - 30);
  }
  EXPECT_FALSE(solver.settled());
  solver.solve(true);
  EXPECT_TRUE(solver.settled());
  EXPECT_TRUE(solver.solve(true).free.empty()) << "what is settled is not solved again";
}

// Running out of iterations is not the end: the next rounds go on until the optimum.
TEST(IncrementalSolverTest, WholeGraphSolveGoesOnInLaterRounds) {
  SolverOptions options;
  options.max_iterations = 1;
  IncrementalSolver solver(options);
  solver.hold(solver.addPose(SE3()));
  for (int k = 1; k <= 40; ++k) {
    solver.addPose(SE3());
    join(solver, k - 1, k, se3Exp((Vector6d() << 1, 0, 0.1, 0.05, 0.1, 0.15).finished()), 0.05);
  }
  EXPECT_FALSE(solver.solve(true).converged);
  int rounds = 1;
  while (!solver.settled() && rounds < 100) {
    EXPECT_TRUE(solver.solve(false).whole);
    ++rounds;
  }
  EXPECT_GT(rounds, 2);
  for (int f = 0; f < 40; ++f) EXPECT_LT(solver.chi2(f), 1e-8);
}

}  // namespace
}  // namespace sgraphs
