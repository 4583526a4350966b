// Planes as states: switching and rebinding of factors, and covariances against ceres::Covariance.
#include <ceres/covariance.h>
#include <ceres/problem.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "backend/factors/faces_cost.h"
#include "backend/factors/plane_manifold.h"
#include "backend/factors/pose_manifold.h"
#include "backend/factors/pose_plane_cost.h"
#include "backend/factors/relative_pose_cost.h"
#include "tests/backend/solver/plane_world.h"

namespace sgraphs {
namespace {

using testing_support::makePlaneWorld;
using testing_support::PlaneRun;
using testing_support::PlaneWorld;

PlaneObservation wallAhead(double distance, double sigma_m) {
  PlaneObservation z;
  z.normal_body = -Eigen::Vector3d::UnitX();
  z.centroid_body = Eigen::Vector3d(distance, 0, 0);
  z.covariance = Eigen::Vector3d(1e-6, 1e-6, sigma_m * sigma_m).asDiagonal();
  return z;
}

PlaneState wallAt(double x) {
  return {-Eigen::Vector3d::UnitX(), 0.0, {x, 0, 0}};
}

double wallOf(const IncrementalSolver& solver, int plane) {
  const PlaneState state = solver.plane(plane);
  return (state.anchor - state.offset_m * state.normal).x();
}

// Seen at 5 m (sigma 1 cm) and at 5.5 m (sigma 2 cm): weights 4 and 1, hence 5.1 m. The offset's covariance
// is 1 / (1e4 + 2.5e3).
struct TwoSightings {
  IncrementalSolver solver{{}};
  int pose = solver.addPose(SE3());
  int plane = solver.addPlane(wallAt(4.0));
  int first = -1, second = -1;

  TwoSightings() {
    solver.hold(pose);
    first = solver.addFactor(PosePlaneCost::Create(wallAhead(5.0, 0.01)), {pose, plane});
    second = solver.addFactor(PosePlaneCost::Create(wallAhead(5.5, 0.02)), {pose, plane});
  }
};

TEST(PlaneStatesTest, SightingsAreWeighedByTheirInformation) {
  TwoSightings two;
  two.solver.solve(true);
  EXPECT_NEAR(wallOf(two.solver, two.plane), 5.1, 1e-6);
  const auto covariance = two.solver.planeCovariance(two.plane);
  ASSERT_TRUE(covariance);
  // The anchor, at 4 m, lies on the normal through the centroids: its offset is that of the centroids.
  EXPECT_NEAR((*covariance)(2, 2), 1.0 / 12500.0, 1e-9);
}

TEST(PlaneStatesTest, DisabledFactorHasNoInfluenceUntilItIsEnabledAgain) {
  TwoSightings two;
  two.solver.solve(true);
  two.solver.setEnabled(two.second, false);
  EXPECT_FALSE(two.solver.settled());
  two.solver.solve(true);
  EXPECT_NEAR(wallOf(two.solver, two.plane), 5.0, 1e-6);
  EXPECT_NEAR((*two.solver.planeCovariance(two.plane))(2, 2), 1e-4, 1e-9);
  EXPECT_NEAR(two.solver.chi2(two.second), 625.0, 1e-2) << "what it would say is still known";
  two.solver.setEnabled(two.second, true);
  two.solver.solve(true);
  EXPECT_NEAR(wallOf(two.solver, two.plane), 5.1, 1e-6);
}

// Two planes found to be one: the second's sighting moves over, and the result is as if it had been the
// first's from the start.
TEST(PlaneStatesTest, ReboundFactorCountsForTheOtherPlane) {
  IncrementalSolver solver({});
  const int pose = solver.addPose(SE3());
  solver.hold(pose);
  const int a = solver.addPlane(wallAt(4.0)), b = solver.addPlane(wallAt(6.0));
  solver.addFactor(PosePlaneCost::Create(wallAhead(5.0, 0.01)), {pose, a});
  const int second = solver.addFactor(PosePlaneCost::Create(wallAhead(5.5, 0.02)), {pose, b});
  const int faces = solver.addFactor(FacesCost::Create(0.01), {a, b});
  solver.solve(true);
  EXPECT_NEAR(wallOf(solver, b), 5.5, 1e-6);
  EXPECT_THROW(solver.rebind(faces, b, a), std::logic_error) << "a plane against itself";
  EXPECT_THROW(solver.rebind(second, b, pose), std::logic_error) << "a pose is no plane";
  EXPECT_THROW(solver.rebind(second, a, b), std::logic_error) << "not bound to it";
  solver.setEnabled(faces, false);
  solver.rebind(second, b, a);
  solver.solve(true);
  EXPECT_NEAR(wallOf(solver, a), 5.1, 1e-6);
  EXPECT_NEAR(wallOf(solver, b), 5.5, 1e-6) << "bound to nothing, it stays";
}

TEST(PlaneStatesTest, FactorsMustFitTheirStates) {
  IncrementalSolver solver({});
  const int pose = solver.addPose(SE3()), plane = solver.addPlane(wallAt(1));
  const int up = solver.addSharedUnitVector(Eigen::Vector3d::UnitZ());
  EXPECT_THROW(solver.addFactor(PosePlaneCost::Create(wallAhead(1, 1)), {pose}), std::logic_error);
  EXPECT_THROW(solver.addFactor(PosePlaneCost::Create(wallAhead(1, 1)), {pose, up}), std::logic_error);
  EXPECT_THROW(solver.addFactor(FacesCost::Create(1), {plane, plane}), std::logic_error);
  EXPECT_TRUE(solver.settled()) << "refused factors leave nothing behind";
}

// Another anchor is another way to write the same state: no residual changes.
TEST(PlaneStatesTest, ReanchoringChangesNoResidual) {
  TwoSightings two;
  two.solver.solve(true);
  const double before = two.solver.chi2(two.first) + two.solver.chi2(two.second);
  two.solver.setPlane(two.plane, two.solver.plane(two.plane).anchoredAt({7, -3, 2}));
  EXPECT_NEAR(two.solver.chi2(two.first) + two.solver.chi2(two.second), before, 1e-9 * before);
}

// All marginals of a graph with poses, planes and up, against Ceres' dense algorithm.
TEST(PlaneStatesTest, CovariancesAreThoseOfCeres) {
  const PlaneWorld world = makePlaneWorld(
      {.num_keyframes = 24, .per_lap = 16, .num_planes = 14, .seen_per_keyframe = 5, .seed = 9});
  PlaneRun run(world, {});
  for (int k = 0; k < world.options.num_keyframes; ++k) run.addRound(k);
  run.solver().solve(true);
  run.solver().setEnabled(run.factors()[20].id, false);
  IncrementalSolver& solver = run.solver();

  PlaneRun::Batch batch(run);
  ceres::Covariance::Options options;
  options.algorithm_type = ceres::DENSE_SVD;
  ceres::Covariance covariance(options);
  std::vector<const double*> blocks;
  for (const auto& [state, x] : batch.poses) blocks.push_back(x);
  for (const auto& [state, x] : batch.planes) blocks.push_back(x);
  ASSERT_TRUE(covariance.Compute(blocks, &batch.problem));

  const auto poses = solver.poseCovariances();
  const auto planes = solver.planeCovariances();
  ASSERT_EQ(poses.size(), batch.poses.size());
  ASSERT_EQ(planes.size(), batch.planes.size());
  for (const auto& [state, x] : batch.poses) {
    Eigen::Matrix<double, 6, 6, Eigen::RowMajor> expected;
    ASSERT_TRUE(covariance.GetCovarianceBlockInTangentSpace(x, x, expected.data()));
    EXPECT_LT((poses.at(state) - expected).norm(), 1e-6 * expected.norm() + 1e-15);
    EXPECT_LT((*solver.covariance(state) - expected).norm(), 1e-6 * expected.norm() + 1e-15);
  }
  for (const auto& [state, x] : batch.planes) {
    Eigen::Matrix<double, 3, 3, Eigen::RowMajor> expected;
    ASSERT_TRUE(covariance.GetCovarianceBlockInTangentSpace(x, x, expected.data()));
    EXPECT_LT((planes.at(state) - expected).norm(), 1e-6 * expected.norm());
    EXPECT_LT((*solver.planeCovariance(state) - expected).norm(), 1e-6 * expected.norm());
  }
  const auto [pose, pose_x] = *batch.poses.rbegin();
  const auto [plane, plane_x] = *batch.planes.begin();
  Eigen::Matrix<double, 3, 6, Eigen::RowMajor> cross;
  ASSERT_TRUE(covariance.GetCovarianceBlockInTangentSpace(plane_x, pose_x, cross.data()));
  const auto joint = solver.jointCovariance({plane, pose});
  ASSERT_TRUE(joint);
  EXPECT_LT((joint->topRightCorner<3, 6>() - cross).norm(), 1e-6 * cross.norm());
  EXPECT_LT((joint->bottomRightCorner<6, 6>() - poses.at(pose)).norm(), 1e-9 * poses.at(pose).norm());
}

}  // namespace
}  // namespace sgraphs
