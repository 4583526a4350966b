#include "backend/solver/round_solver.h"

#include <algorithm>
#include <cmath>

#include "backend/solver/region_solve.h"

namespace sgraphs {
namespace {

// Neighbourhoods begin with this many steps along factors, and grow by half as much again each time.
constexpr int kFirstHops = 3;
// Steps with the former factorisation in one round, and by how much each must be smaller than the last.
constexpr int kMaxPasses = 4;
constexpr double kContraction = 0.7;

}  // namespace

RoundSolver::Report RoundSolver::solve(bool whole) {
  Report report;
  if (settled_) return report;
  forgetMarginals();
  whole = whole || unfinished_ || static_cast<int>(graph.states.size()) <= options_.small_graph;
  if (!whole && !seeds_.empty())
    whole = !(rested_planes_.empty() &&
                      std::none_of(seeds_.begin(), seeds_.end(), [this](int state) { return isPlane(state); })
                  ? solveAlongPoses(report)
                  : solveWithPlanes(report));
  seeds_.clear();
  if (whole) solveWhole(report);
  return report;
}

void RoundSolver::markChanged(const std::vector<int>& states) {
  seeds_.insert(seeds_.end(), states.begin(), states.end());
  settled_ = false;
  forgetMarginals();
}

const Marginals& RoundSolver::marginals() {
  if (!marginals_) marginals_ = std::make_shared<const Marginals>(graph);
  return *marginals_;
}

bool RoundSolver::solveAlongPoses(Report& report) {
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
      return driftWithin(unresolved) && sharedStatesRest();
    }
    const int more = (hops + 1) / 2;
    region.grow(moving, more);
    hops += more;
  }
}

// The held states at the rim that must be free too; `unresolved` is the largest step among all of them.
std::vector<int> RoundSolver::wouldMove(const Region& region, StepSize& unresolved) const {
  const auto held = static_cast<double>(graph.states.size() - region.members().size());
  const double leverage = std::min(held, static_cast<double>(options_.max_leverage));
  std::vector<int> moving;
  for (const int state : region.rim()) {
    const StepSize alone = graph.newtonStep(state);
    const StepSize step{leverage * alone.m, leverage * alone.rad};
    unresolved = {std::max(unresolved.m, step.m), std::max(unresolved.rad, step.rad)};
    if (step.m > options_.grow_step_m || step.rad > options_.grow_step_rad) moving.push_back(state);
  }
  return moving;
}

bool RoundSolver::driftWithin(const StepSize& unresolved) {
  drift_ = {std::hypot(drift_.m, unresolved.m), std::hypot(drift_.rad, unresolved.rad)};
  return drift_.m <= options_.drift_m && drift_.rad <= options_.drift_rad;
}

// A shared state takes many others along when it moves: its step is the gradient times its covariance, as
// of the last whole-graph solve.
bool RoundSolver::sharedStatesRest() const {
  for (const auto& [state, covariance] : shared_covariances_) {
    const StepSize step = graph.sizeOf(state, covariance * graph.normalEquations(state).g);
    if (step.m > options_.drift_m || step.rad > options_.shared_drift_rad) return false;
  }
  return true;
}

bool RoundSolver::solveWithPlanes(Report& report) {
  if (!last_whole_ || !last_whole_->valid()) return false;
  std::vector<int> seeds = seeds_;
  for (size_t i = last_whole_->numStates(); i < graph.states.size(); ++i)
    seeds.push_back(static_cast<int>(i));
  Region region(graph);
  region.grow(seeds, kFirstHops);
  if (static_cast<int>(region.members().size()) > options_.max_region_planes) return false;
  bool everything_moved = false;
  double last_step = 0;
  for (int pass = 0; pass < kMaxPasses; ++pass) {
    const RegionOutcome outcome =
        solveRegion(graph, region.members(), options_.max_iterations, options_.settled_step_local);
    report.iterations += outcome.iterations;
    if (!outcome.converged) return false;
    const std::vector<Marginals::StateVector> steps = last_whole_->newtonSteps(pulls(region));
    const StepSize step = largest(steps);
    if (step.m <= options_.rest_step_m && step.rad <= options_.rest_step_rad) {
      report.free = region.members();
      if (everything_moved)
        for (const auto& [state, unused] : steps) report.free.push_back(state);
      std::sort(report.free.begin(), report.free.end());
      report.free.erase(std::unique(report.free.begin(), report.free.end()), report.free.end());
      return driftWithin(step);
    }
    const double size = std::max(step.m / options_.rest_step_m, step.rad / options_.rest_step_rad);
    if (step.m > options_.max_step_m || step.rad > options_.max_step_rad) return false;
    if (pass > 0 && size > kContraction * last_step) return false;
    last_step = size;
    apply(steps);
    everything_moved = true;
  }
  return false;
}

// Gradients of the states next to the region: those of its rim, of the poses that see a plane that moved,
// and of shared states.
std::vector<Marginals::StateVector> RoundSolver::pulls(const Region& region) {
  std::vector<int> pulled = region.rim();
  for (const int state : region.members()) {
    if (!pullsAtObservers(state)) continue;
    const std::vector<int> observers = region.observers(state);
    pulled.insert(pulled.end(), observers.begin(), observers.end());
    rested_planes_[state] = graph.states[static_cast<size_t>(state)].x;
  }
  for (size_t i = 0; i < last_whole_->numStates(); ++i)
    if (graph.states[i].shared && !graph.states[i].held) pulled.push_back(static_cast<int>(i));
  std::sort(pulled.begin(), pulled.end());
  pulled.erase(std::unique(pulled.begin(), pulled.end()), pulled.end());
  std::vector<Marginals::StateVector> gradients;
  for (const int state : pulled) gradients.emplace_back(state, graph.normalEquations(state).g);
  return gradients;
}

// A plane carries the poses that see it along by no more than it moved itself since they were heeded. A
// floor seen from everywhere moves with each observation by next to nothing.
bool RoundSolver::pullsAtObservers(int state) const {
  if (!isPlane(state)) return false;
  const auto rested = rested_planes_.find(state);
  if (rested == rested_planes_.end()) return true;
  const StepSize moved = graph.difference(state, rested->second);
  return moved.m > options_.rest_plane_m || moved.rad > options_.rest_plane_rad;
}

StepSize RoundSolver::largest(const std::vector<Marginals::StateVector>& steps) const {
  StepSize most;
  for (const auto& [state, step] : steps) {
    const StepSize size = graph.sizeOf(state, step);
    most = {std::max(most.m, size.m), std::max(most.rad, size.rad)};
  }
  return most;
}

void RoundSolver::apply(const std::vector<Marginals::StateVector>& steps) {
  for (const auto& [state, step] : steps) {
    graph.move(state, step, graph.states[static_cast<size_t>(state)].x);
    // What it moved before and was not heeded for is not forgotten.
    if (const auto rested = rested_planes_.find(state); rested != rested_planes_.end())
      graph.move(state, step, rested->second);
  }
}

void RoundSolver::solveWhole(Report& report) {
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
  rested_planes_.clear();
  for (const int state : report.free)
    if (isPlane(state)) rested_planes_[state] = graph.states[static_cast<size_t>(state)].x;
  if (settled_) remember();
}

// What local rounds need of the whole graph.
void RoundSolver::remember() {
  if (!rested_planes_.empty()) {
    marginals();
    last_whole_ = marginals_;
    return;
  }
  shared_covariances_.clear();
  for (size_t i = 0; i < graph.states.size(); ++i) {
    const auto state = static_cast<int>(i);
    if (!graph.states[i].shared || graph.states[i].factors.empty()) continue;
    if (const auto covariance = marginals().covariance(state))
      shared_covariances_.emplace_back(state, *covariance);
  }
}

}  // namespace sgraphs
