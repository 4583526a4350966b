#pragma once

#include <array>
#include <map>
#include <memory>
#include <vector>

#include "backend/solver/incremental_solver.h"
#include "backend/solver/marginal_covariance.h"
#include "backend/solver/region.h"
#include "backend/solver/state_graph.h"

namespace sgraphs {

// The rounds of IncrementalSolver: which states are free, and when the whole graph is due.
//
// In a graph of poses alone, a neighbourhood grows along the factors until its rim would not move. Planes
// bind poses far and near into modes that no rim shows: there the neighbourhood is solved by itself, and what
// it pulls at is passed to all other states in one step with the factorisation of the last whole-graph
// solve, which lacks only what came since. If that does not come to rest at once (new observations changed
// the stiffness, as where a loop closes), the whole graph is solved.
class RoundSolver {
 public:
  using Report = IncrementalSolver::Report;

  explicit RoundSolver(const SolverOptions& options) : options_(options) {}

  Report solve(bool whole);
  void markChanged(const std::vector<int>& states);
  bool settled() const { return settled_; }

  // Factorised once for all covariances asked for between two changes.
  const Marginals& marginals();
  void forgetMarginals() { marginals_.reset(); }
  // To be called where a state was changed from outside: other coordinates than those of the factorisation.
  void forgetWhole() {
    forgetMarginals();
    last_whole_.reset();
  }

  StateGraph graph;

 private:
  // False: what is new is not local, or too much has been left unresolved.
  bool solveAlongPoses(Report& report);
  bool solveWithPlanes(Report& report);
  void solveWhole(Report& report);

  std::vector<int> wouldMove(const Region& region, StepSize& unresolved) const;
  bool sharedStatesRest() const;
  void remember();
  bool driftWithin(const StepSize& unresolved);

  const std::map<int, Eigen::VectorXd>& pulls(const Region& region);
  void pullAtObservers(int plane, const Region& region);
  StepSize largest(const std::vector<Marginals::StateVector>& steps) const;
  void apply(const std::vector<Marginals::StateVector>& steps, double relaxation);
  bool isPlane(int state) const { return graph.states[static_cast<size_t>(state)].kind == StateKind::kPlane; }

  SolverOptions options_;
  std::vector<int> seeds_;   // states of the factors added since the last solve
  bool unfinished_ = false;  // the last whole-graph solve ran out of iterations
  bool settled_ = true;
  std::shared_ptr<const Marginals> marginals_;
  std::shared_ptr<const Marginals> last_whole_;  // as of the last whole-graph solve
  std::vector<std::pair<int, Eigen::MatrixXd>> shared_covariances_;
  std::map<int, Eigen::VectorXd> pulls_;                // gradients not yet passed on, by state
  std::map<int, std::array<double, 7>> heeded_planes_;  // as they were when those who see them were pulled
  StepSize drift_;                                      // left unresolved since the last whole-graph solve
};

}  // namespace sgraphs
