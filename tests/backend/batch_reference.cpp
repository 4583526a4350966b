#include "tests/backend/batch_reference.h"

#include <ceres/covariance.h>
#include <ceres/loss_function.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include <array>

#include "backend/factors/pose_manifold.h"
#include "backend/factors/relative_pose_cost.h"
#include "backend/factors/unit_vector_manifold.h"
#include "backend/factors/up_cost.h"

namespace sgraphs::testing_support {
namespace {

struct Batch {
  std::map<KeyframeId, std::array<double, 7>> poses;
  Eigen::Vector3d up;
  ceres::Problem problem;

  Batch(const SituationalGraph& graph, double loop_cauchy_scale) : up(graph.up_map) {
    for (const auto& [id, node] : graph.keyframes) {
      PoseManifold::store(node.T_map_body, poses[id].data());
      problem.AddParameterBlock(poses[id].data(), 7, new PoseManifold);
    }
    problem.SetParameterBlockConstant(poses.begin()->second.data());
    for (const RelativePoseFactor& factor : graph.relative_poses) {
      const RelativePose& z = factor.measurement;
      ceres::LossFunction* loss =
          z.kind == RelativePoseKind::kLoop ? new ceres::CauchyLoss(loop_cauchy_scale) : nullptr;
      problem.AddResidualBlock(RelativePoseCost::Create(z.T_from_to, z.covariance).release(), loss,
                               poses.at(z.from).data(), poses.at(z.to).data());
    }
    if (graph.ups.empty()) return;
    problem.AddParameterBlock(up.data(), 3, new UnitVectorManifold);
    for (const UpFactor& factor : graph.ups)
      problem.AddResidualBlock(UpCost::Create(factor.up_body, factor.sigma_rad).release(), nullptr,
                               poses.at(factor.keyframe).data(), up.data());
  }
};

}  // namespace

BatchResult solveBatch(const SituationalGraph& graph, double loop_cauchy_scale, double* cost_before) {
  Batch batch(graph, loop_cauchy_scale);
  if (cost_before != nullptr)
    batch.problem.Evaluate(ceres::Problem::EvaluateOptions(), cost_before, nullptr, nullptr, nullptr);
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  options.sparse_linear_algebra_library_type = ceres::EIGEN_SPARSE;
  options.initial_trust_region_radius = 1e10;
  options.max_num_iterations = 200;
  options.function_tolerance = 1e-16;
  options.parameter_tolerance = 1e-14;
  options.gradient_tolerance = 1e-14;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &batch.problem, &summary);
  BatchResult result;
  for (const auto& [id, x] : batch.poses) result.T_map_body[id] = PoseManifold::load(x.data());
  result.up_map = batch.up;
  result.cost = summary.final_cost;
  result.residuals = summary.num_residuals;
  result.free_dof = summary.num_effective_parameters_reduced;
  return result;
}

bool batchCovariance(const SituationalGraph& graph, double loop_cauchy_scale, KeyframeId id, Matrix6d& out) {
  Batch batch(graph, loop_cauchy_scale);
  ceres::Covariance::Options options;
  options.algorithm_type = ceres::DENSE_SVD;
  ceres::Covariance covariance(options);
  const double* x = batch.poses.at(id).data();
  const std::vector<std::pair<const double*, const double*>> blocks{{x, x}};
  if (!covariance.Compute(blocks, &batch.problem)) return false;
  Eigen::Matrix<double, 6, 6, Eigen::RowMajor> block;
  if (!covariance.GetCovarianceBlockInTangentSpace(x, x, block.data())) return false;
  out = block;
  return true;
}

}  // namespace sgraphs::testing_support
