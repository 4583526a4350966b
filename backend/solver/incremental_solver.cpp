#include "backend/solver/incremental_solver.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "backend/solver/marginal_covariance.h"
#include "backend/solver/region.h"
#include "backend/solver/region_solve.h"
#include "backend/solver/state_graph.h"

namespace sgraphs {
namespace {

// Neighbourhoods begin with this many steps along factors, and grow by half as much again each time.
constexpr int kFirstHops = 3;

}  // namespace

class IncrementalSolver::Impl {
 public:
  explicit Impl(const SolverOptions& options) : options_(options) {}

  Report solve(bool whole) {
    Report report;
    if (settled_) return report;
    forgetMarginals();
    whole = whole || unfinished_ || static_cast<int>(graph.states.size()) <= options_.small_graph;
    if (!whole && !seeds_.empty()) whole = !solveLocal(report);
    seeds_.clear();
    if (whole) solveWhole(report);
    return report;
  }

  void markChanged(const std::vector<int>& states) {
    seeds_.insert(seeds_.end(), states.begin(), states.end());
    settled_ = false;
    forgetMarginals();
  }
  bool settled() const { return settled_; }

  // Factorised once for all covariances asked for between two changes.
  const Marginals& marginals() {
    if (!marginals_) marginals_.emplace(graph);
    return *marginals_;
  }
  void forgetMarginals() { marginals_.reset(); }

  template <typename Covariance>
  std::map<StateId, Covariance> covariancesOf(StateKind kind) {
    std::map<StateId, Covariance> out;
    const std::vector<Eigen::MatrixXd> all = marginals().allCovariances();
    for (size_t i = 0; i < all.size(); ++i)
      if (graph.states[i].kind == kind) out.emplace(static_cast<StateId>(i), all[i]);
    return out;
  }

  StateGraph graph;

 private:
  // False: what is new is not local, or too much has been left unresolved.
  bool solveLocal(Report& report) {
    Region region(graph);
    int hops = kFirstHops;
    region.grow(seeds_, hops);
    for (;;) {
      if (static_cast<int>(region.members().size()) > options_.max_region) return false;
      const RegionOutcome outcome =
          solveRegion(graph, region.members(), options_.max_iterations, options_.settled_step_local);
      report.iterations += outcome.iterations;
      if (!outcome.converged) return false;
      StepSize unresolved;
      const std::vector<int> moving = wouldMove(region, unresolved);
      if (moving.empty()) {
        report.free = region.members();
        rest(region);
        drift_ = {std::hypot(drift_.m, unresolved.m), std::hypot(drift_.rad, unresolved.rad)};
        return drift_.m <= options_.drift_m && drift_.rad <= options_.drift_rad && sharedStatesRest();
      }
      const int more = (hops + 1) / 2;
      region.grow(moving, more);
      hops += more;
    }
  }

  // The held states that the region pulls at so much that they must be free too; `unresolved` is the largest
  // step among all that were looked at.
  std::vector<int> wouldMove(const Region& region, StepSize& unresolved) const {
    std::vector<int> candidates = region.rim();
    for (const int state : region.members()) {
      if (!pullsAtObservers(state)) continue;
      const std::vector<int> observers = region.observers(state);
      candidates.insert(candidates.end(), observers.begin(), observers.end());
    }
    std::sort(candidates.begin(), candidates.end());
    candidates.erase(std::unique(candidates.begin(), candidates.end()), candidates.end());
    const double held = static_cast<double>(graph.states.size() - region.members().size());
    std::vector<int> moving;
    for (const int state : candidates) {
      const StepSize alone = graph.newtonStep(state);
      const double leverage = std::min(held, leverageOf(state));
      const StepSize step{leverage * alone.m, leverage * alone.rad};
      unresolved = {std::max(unresolved.m, step.m), std::max(unresolved.rad, step.rad)};
      if (step.m > options_.grow_step_m || step.rad > options_.grow_step_rad) moving.push_back(state);
    }
    return moving;
  }

  double leverageOf(int state) const {
    for (const int factor : graph.states[static_cast<size_t>(state)].factors)
      for (const int other : graph.factors[static_cast<size_t>(factor)].states)
        if (graph.states[static_cast<size_t>(other)].kind == StateKind::kPlane)
          return options_.max_leverage_planes;
    return options_.max_leverage;
  }

  // A plane carries the poses that see it along by no more than it moved itself since they were looked at.
  bool pullsAtObservers(int state) const {
    if (graph.states[static_cast<size_t>(state)].kind != StateKind::kPlane) return false;
    const auto rested = rested_planes_.find(state);
    if (rested == rested_planes_.end()) return true;
    const StepSize moved = graph.difference(state, rested->second);
    return moved.m > options_.grow_step_m || moved.rad > options_.grow_step_rad;
  }

  void rest(const Region& region) {
    for (const int state : region.members())
      if (pullsAtObservers(state)) rested_planes_[state] = graph.states[static_cast<size_t>(state)].x;
  }

  // A shared state takes many others along when it moves: its step is the gradient times its covariance, as
  // of the last whole-graph solve.
  bool sharedStatesRest() const {
    for (const auto& [state, covariance] : shared_covariances_) {
      const StepSize step = graph.sizeOf(state, covariance * graph.normalEquations(state).g);
      if (step.m > options_.drift_m || step.rad > options_.shared_drift_rad) return false;
    }
    return true;
  }

  void rememberSharedCovariances() {
    shared_covariances_.clear();
    for (size_t i = 0; i < graph.states.size(); ++i) {
      const auto state = static_cast<int>(i);
      if (!graph.states[i].shared || graph.states[i].factors.empty()) continue;
      if (const auto covariance = marginals().covariance(state))
        shared_covariances_.emplace_back(state, *covariance);
    }
  }

  void solveWhole(Report& report) {
    std::vector<int> free;
    for (size_t i = 0; i < graph.states.size(); ++i)
      if (!graph.states[i].held && !graph.states[i].factors.empty()) free.push_back(static_cast<int>(i));
    const RegionOutcome outcome =
        solveRegion(graph, free, options_.max_iterations, options_.settled_step_whole);
    report.whole = true;
    report.converged = outcome.converged;
    report.iterations += outcome.iterations;
    report.free = std::move(free);
    unfinished_ = !outcome.converged;
    settled_ = outcome.converged;
    drift_ = {};
    for (const int state : report.free)
      if (graph.states[static_cast<size_t>(state)].kind == StateKind::kPlane)
        rested_planes_[state] = graph.states[static_cast<size_t>(state)].x;
    if (settled_) rememberSharedCovariances();
  }

  SolverOptions options_;
  std::vector<int> seeds_;   // states of the factors added since the last solve
  bool unfinished_ = false;  // the last whole-graph solve ran out of iterations
  bool settled_ = true;
  std::optional<Marginals> marginals_;
  std::vector<std::pair<int, Eigen::MatrixXd>> shared_covariances_;
  std::map<int, std::array<double, 7>> rested_planes_;  // as they were when their observers were looked at
  StepSize drift_;                                      // left unresolved since the last whole-graph solve
};

IncrementalSolver::IncrementalSolver(const SolverOptions& options) : impl_(std::make_unique<Impl>(options)) {}
IncrementalSolver::~IncrementalSolver() = default;

IncrementalSolver::StateId IncrementalSolver::addPose(const SE3& T) {
  const StateId id = impl_->graph.addState(StateKind::kPose);
  setPose(id, T);
  return id;
}

IncrementalSolver::StateId IncrementalSolver::addPlane(const PlaneState& plane) {
  const StateId id = impl_->graph.addState(StateKind::kPlane);
  setPlane(id, plane);
  return id;
}

IncrementalSolver::StateId IncrementalSolver::addSharedUnitVector(const Eigen::Vector3d& n) {
  const StateId id = impl_->graph.addState(StateKind::kUnitVector);
  impl_->graph.states.back().shared = true;
  setUnitVector(id, n);
  return id;
}

void IncrementalSolver::hold(StateId state) {
  impl_->graph.states.at(static_cast<size_t>(state)).held = true;
}

IncrementalSolver::FactorId IncrementalSolver::addFactor(std::unique_ptr<ceres::CostFunction> cost,
                                                         std::vector<StateId> states,
                                                         std::optional<double> cauchy_scale) {
  Factor factor;
  factor.cost = std::move(cost);
  if (cauchy_scale) factor.loss = std::make_unique<ceres::CauchyLoss>(*cauchy_scale);
  factor.states = states;
  const FactorId id = impl_->graph.addFactor(std::move(factor));
  impl_->markChanged(states);
  return id;
}

void IncrementalSolver::setEnabled(FactorId factor, bool enabled) {
  if (this->enabled(factor) == enabled) return;
  impl_->graph.setEnabled(factor, enabled);
  impl_->markChanged(impl_->graph.factors[static_cast<size_t>(factor)].states);
}

bool IncrementalSolver::enabled(FactorId factor) const {
  return impl_->graph.factors.at(static_cast<size_t>(factor)).enabled;
}

void IncrementalSolver::rebind(FactorId factor, StateId from, StateId to) {
  impl_->graph.rebind(factor, from, to);
  if (!enabled(factor)) return;
  impl_->markChanged(impl_->graph.factors[static_cast<size_t>(factor)].states);
  impl_->markChanged({from});
}

SE3 IncrementalSolver::pose(StateId state) const {
  return PoseManifold::load(impl_->graph.states.at(static_cast<size_t>(state)).x.data());
}

void IncrementalSolver::setPose(StateId state, const SE3& T) {
  impl_->forgetMarginals();
  PoseManifold::store(T, impl_->graph.states.at(static_cast<size_t>(state)).x.data());
}

PlaneState IncrementalSolver::plane(StateId state) const {
  return PlaneManifold::load(impl_->graph.states.at(static_cast<size_t>(state)).x.data());
}

void IncrementalSolver::setPlane(StateId state, const PlaneState& plane) {
  impl_->forgetMarginals();
  PlaneManifold::store(plane, impl_->graph.states.at(static_cast<size_t>(state)).x.data());
}

Eigen::Vector3d IncrementalSolver::unitVector(StateId state) const {
  return Eigen::Vector3d(impl_->graph.states.at(static_cast<size_t>(state)).x.data());
}

void IncrementalSolver::setUnitVector(StateId state, const Eigen::Vector3d& n) {
  impl_->forgetMarginals();
  std::copy_n(n.data(), 3, impl_->graph.states.at(static_cast<size_t>(state)).x.begin());
}

IncrementalSolver::Report IncrementalSolver::solve(bool whole) {
  return impl_->solve(whole);
}

bool IncrementalSolver::settled() const {
  return impl_->settled();
}

double IncrementalSolver::chi2(FactorId factor) const {
  return impl_->graph.chi2(factor);
}

int IncrementalSolver::numResiduals(FactorId factor) const {
  return impl_->graph.factors.at(static_cast<size_t>(factor)).cost->num_residuals();
}

std::optional<Matrix6d> IncrementalSolver::covariance(StateId pose) const {
  const std::optional<Eigen::MatrixXd> covariance = impl_->marginals().covariance(pose);
  return covariance ? std::optional<Matrix6d>(*covariance) : std::nullopt;
}

std::optional<Eigen::Matrix3d> IncrementalSolver::planeCovariance(StateId plane) const {
  const std::optional<Eigen::MatrixXd> covariance = impl_->marginals().covariance(plane);
  return covariance ? std::optional<Eigen::Matrix3d>(*covariance) : std::nullopt;
}

std::optional<Eigen::MatrixXd> IncrementalSolver::jointCovariance(const std::vector<StateId>& states) const {
  return impl_->marginals().covariance(states);
}

std::map<IncrementalSolver::StateId, Matrix6d> IncrementalSolver::poseCovariances() const {
  return impl_->covariancesOf<Matrix6d>(StateKind::kPose);
}

std::map<IncrementalSolver::StateId, Eigen::Matrix3d> IncrementalSolver::planeCovariances() const {
  return impl_->covariancesOf<Eigen::Matrix3d>(StateKind::kPlane);
}

}  // namespace sgraphs
