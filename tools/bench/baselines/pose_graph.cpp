#include "tools/bench/baselines/pose_graph.h"

#include <ceres/ceres.h>

#include <array>

#include "backend/factors/pose_manifold.h"
#include "backend/factors/relative_pose_cost.h"

namespace sgraphs::bench {

std::vector<SE3> optimisePoses(const std::vector<SE3>& initial, const std::vector<PoseEdge>& edges) {
  if (initial.empty() || edges.empty()) return initial;
  std::vector<std::array<double, PoseManifold::kAmbientSize>> states(initial.size());
  ceres::Problem problem;
  for (size_t i = 0; i < initial.size(); ++i) {
    PoseManifold::store(initial[i], states[i].data());
    problem.AddParameterBlock(states[i].data(), PoseManifold::kAmbientSize, new PoseManifold);
  }
  problem.SetParameterBlockConstant(states.front().data());
  for (const PoseEdge& edge : edges)
    problem.AddResidualBlock(RelativePoseCost::Create(edge.T_from_to, edge.covariance).release(),
                             edge.loop ? new ceres::HuberLoss(1.0) : nullptr, states[edge.from].data(),
                             states[edge.to].data());
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  options.sparse_linear_algebra_library_type = ceres::EIGEN_SPARSE;
  options.max_num_iterations = 100;
  options.num_threads = 1;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  std::vector<SE3> poses;
  poses.reserve(states.size());
  for (const auto& state : states) poses.push_back(PoseManifold::load(state.data()));
  return poses;
}

}  // namespace sgraphs::bench
