#include "backend/solver/region_solve.h"

#include <ceres/iteration_callback.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include <algorithm>
#include <cmath>

namespace sgraphs {
namespace {

// Gauss-Newton converges quadratically here: once a step is small, the next is far smaller. Ceres' own
// tolerances are relative to the cost and to the distance from the origin, and would stop early in a large
// map.
class StopWhenSettled final : public ceres::IterationCallback {
 public:
  StopWhenSettled(double step_rms, size_t num_free)
      : max_step_norm_(step_rms * std::sqrt(static_cast<double>(num_free))) {}
  ceres::CallbackReturnType operator()(const ceres::IterationSummary& summary) override {
    const bool settled =
        summary.iteration > 0 && summary.step_is_successful && summary.step_norm < max_step_norm_;
    return settled ? ceres::SOLVER_TERMINATE_SUCCESSFULLY : ceres::SOLVER_CONTINUE;
  }

 private:
  double max_step_norm_;
};

std::vector<int> factorsOf(const StateGraph& graph, const std::vector<int>& free) {
  std::vector<int> factors;
  for (const int state : free) {
    const std::vector<int>& of_state = graph.states[static_cast<size_t>(state)].factors;
    factors.insert(factors.end(), of_state.begin(), of_state.end());
  }
  std::sort(factors.begin(), factors.end());
  factors.erase(std::unique(factors.begin(), factors.end()), factors.end());
  return factors;
}

// Blocks and residuals are added by ascending id, so that elimination order and sums are the same every time.
void fillProblem(StateGraph& graph, const std::vector<int>& free, ceres::Problem& problem) {
  const std::vector<int> factors = factorsOf(graph, free);
  std::vector<int> states;
  for (const int factor : factors) {
    const std::vector<int>& of_factor = graph.factors[static_cast<size_t>(factor)].states;
    states.insert(states.end(), of_factor.begin(), of_factor.end());
  }
  std::sort(states.begin(), states.end());
  states.erase(std::unique(states.begin(), states.end()), states.end());
  for (const int id : states) {
    State& state = graph.states[static_cast<size_t>(id)];
    ceres::Manifold* manifold = graph.manifold(state.kind);
    problem.AddParameterBlock(state.x.data(), manifold->AmbientSize(), manifold);
    if (!std::binary_search(free.begin(), free.end(), id)) problem.SetParameterBlockConstant(state.x.data());
  }
  std::vector<double*> blocks;
  for (const int id : factors) {
    Factor& factor = graph.factors[static_cast<size_t>(id)];
    blocks.clear();
    for (const int state : factor.states) blocks.push_back(graph.states[static_cast<size_t>(state)].x.data());
    problem.AddResidualBlock(factor.cost.get(), factor.loss.get(), blocks);
  }
}

ceres::Problem::Options problemOptions() {
  ceres::Problem::Options options;
  options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.disable_all_safety_checks = true;
  return options;
}

// One thread and Eigen's sparse Cholesky with block AMD: Debian's Ceres reaches SuiteSparse and LAPACK
// through whatever BLAS the alternatives system points at, and results would change with it.
ceres::Solver::Options solverOptions(int max_iterations) {
  ceres::Solver::Options options;
  options.num_threads = 1;
  options.max_num_iterations = max_iterations;
  options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  options.sparse_linear_algebra_library_type = ceres::EIGEN_SPARSE;
  options.dense_linear_algebra_library_type = ceres::EIGEN;
  options.logging_type = ceres::SILENT;
  options.minimizer_progress_to_stdout = false;
  // Nearly undamped at first: the default would hold back the long waves of a trajectory of thousands of
  // keyframes, which are the softest modes by far.
  options.initial_trust_region_radius = 1e8;
  options.function_tolerance = 1e-10;
  options.gradient_tolerance = 1e-12;
  options.parameter_tolerance = 1e-14;
  return options;
}

}  // namespace

RegionOutcome solveRegion(StateGraph& graph, const std::vector<int>& free, int max_iterations,
                          double settled_step) {
  if (free.empty()) return {};
  ceres::Problem problem(problemOptions());
  fillProblem(graph, free, problem);

  ceres::Solver::Options options = solverOptions(max_iterations);
  StopWhenSettled stop(settled_step, free.size());
  options.callbacks.push_back(&stop);
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);

  RegionOutcome outcome;
  outcome.usable = summary.IsSolutionUsable();
  outcome.converged =
      summary.termination_type == ceres::CONVERGENCE || summary.termination_type == ceres::USER_SUCCESS;
  outcome.iterations = static_cast<int>(summary.iterations.size()) - 1;
  return outcome;
}

}  // namespace sgraphs
