#pragma once

#include <map>

#include "backend/graph/situational_graph.h"

namespace sgraphs::testing_support {

struct BatchResult {
  std::map<KeyframeId, SE3> T_map_body;
  Eigen::Vector3d up_map = Eigen::Vector3d::UnitZ();
  double cost = 0;  // with the loops' robust loss: half the weighted sum of squares
  int residuals = 0;
  int free_dof = 0;
};

// The optimum of all factors at once with plain Ceres, far below the backend's tolerances, from the graph's
// own poses. The first keyframe is constant. cost_before: the cost at the graph's poses.
BatchResult solveBatch(const SituationalGraph& graph, double loop_cauchy_scale,
                       double* cost_before = nullptr);

// ceres::Covariance of one keyframe's pose, in the tangent of PoseManifold, at the graph's poses. None: the
// Jacobian is rank deficient.
bool batchCovariance(const SituationalGraph& graph, double loop_cauchy_scale, KeyframeId id, Matrix6d& out);

}  // namespace sgraphs::testing_support
