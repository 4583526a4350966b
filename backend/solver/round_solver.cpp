#include "backend/solver/round_solver.h"

#include <algorithm>
#include <cmath>

#include "backend/solver/region_solve.h"

namespace sgraphs {
namespace {

// Neighbourhoods begin with this many steps along factors, and grow by half as much again each time.
constexpr int kFirstHops = 3;
// Steps with the former factorisation in one round, and by how much each must be smaller than the last.
constexpr int kMaxPasses = 5;
constexpr double kContraction = 0.7;

constexpr double kLeastRelaxation = 0.1;

// What came since the factorisation makes one or two modes stiffer than it knows, and steps along them too
// long: Aitken's relaxation takes their common factor from two successive steps.
double aitken(const std::vector<Marginals::StateVector>& before,
              const std::vector<Marginals::StateVector>& now) {
  double along = 0, squared = 0;
  for (size_t i = 0; i < before.size(); ++i) {
    const Eigen::VectorXd change = now[i].second - before[i].second;
    along += before[i].second.dot(change);
    squared += change.squaredNorm();
  }
  return squared > 0 ? -along / squared : 1.0;
}

void addStates(const std::vector<Marginals::StateVector>& of, std::vector<int>& states) {
  for (const auto& [state, vector] : of) states.push_back(state);
  std::sort(states.begin(), states.end());
  states.erase(std::unique(states.begin(), states.end()), states.end());
}

}  // namespace

RoundSolver::Report RoundSolver::solve(bool whole) {
  Report report;
  if (settled_) return report;
  forgetMarginals();
  whole = whole || unfinished_ || static_cast<int>(graph.states.size()) <= options_.small_graph;
  if (!whole && !seeds_.empty())
    whole = !(heeded_planes_.empty() &&
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
  if (static_cast<int>(region.members().size()) > options_.max_region_planes) {
    return false;
  }
  std::vector<Marginals::StateVector> last_steps;
  double relaxation = 1.0, last_size = 0;
  for (int pass = 0; pass < kMaxPasses; ++pass) {
    const RegionOutcome outcome =
        solveRegion(graph, region.members(), options_.max_iterations, options_.settled_step_local);
    report.iterations += outcome.iterations;
    if (!outcome.converged) return false;
    const std::vector<Marginals::StateVector> steps = last_whole_->newtonSteps(pulls(region));
    const StepSize step = largest(steps);
    if (step.m <= options_.rest_step_m && step.rad <= options_.rest_step_rad) {
      report.free = region.members();
      if (pass > 0) addStates(steps, report.free);
      drift_ = {std::hypot(drift_.m, step.m), std::hypot(drift_.rad, step.rad)};
      return drift_.m <= options_.drift_planes_m && drift_.rad <= options_.drift_planes_rad;
    }
    const double size = std::max(step.m / options_.rest_step_m, step.rad / options_.rest_step_rad);
    if (step.m > options_.max_step_m || step.rad > options_.max_step_rad) return false;
    if (pass > 1 && size > kContraction * last_size) return false;
    if (pass > 0) relaxation = std::clamp(relaxation * aitken(last_steps, steps), kLeastRelaxation, 1.0);
    last_size = size;
    apply(steps, relaxation);
    last_steps = steps;
  }
  return false;
}

// Gradients of the states outside the region: of its rim and of shared states as they are; of the poses that
// see its planes as these moved since they were heeded. Evaluating every factor of all who see a floor would
// be the work of a whole-graph solve.
const std::map<int, Eigen::VectorXd>& RoundSolver::pulls(const Region& region) {
  for (const int state : region.members())
    if (isPlane(state)) pullAtObservers(state, region);
  for (const int state : region.members()) pulls_.erase(state);
  std::vector<int> exact = region.rim();
  for (size_t i = 0; i < last_whole_->numStates(); ++i)
    if (graph.states[i].shared && !graph.states[i].held) exact.push_back(static_cast<int>(i));
  for (const int state : exact) pulls_[state] = graph.normalEquations(state).g;
  return pulls_;
}

void RoundSolver::pullAtObservers(int plane, const Region& region) {
  const State& state = graph.states[static_cast<size_t>(plane)];
  const auto [heeded, fresh] = heeded_planes_.try_emplace(plane, state.x);
  const Eigen::VectorXd moved = graph.difference(plane, heeded->second);
  heeded->second = state.x;
  if (fresh || moved.isZero(0.0)) return;
  for (const int factor : state.factors) {
    const std::vector<int>& states = graph.factors[static_cast<size_t>(factor)].states;
    if (states.size() != 2 || isPlane(states[0]) || !region.couldHold(states[0])) continue;
    const Linearised f = graph.linearise(factor);
    const Eigen::VectorXd pull = f.jacobians[0].transpose() * (f.jacobians[1] * moved);
    const auto [sum, first] = pulls_.try_emplace(states[0], pull);
    if (!first) sum->second += pull;
  }
}

StepSize RoundSolver::largest(const std::vector<Marginals::StateVector>& steps) const {
  StepSize most;
  for (const auto& [state, step] : steps) {
    // What follows is where its walls say, whatever the lever to them.
    if (follows(graph.states[static_cast<size_t>(state)].kind)) continue;
    const StepSize size = graph.sizeOf(state, step);
    most = {std::max(most.m, size.m), std::max(most.rad, size.rad)};
  }
  return most;
}

void RoundSolver::apply(const std::vector<Marginals::StateVector>& steps, double relaxation) {
  for (const auto& [state, full_step] : steps) {
    if (graph.states[static_cast<size_t>(state)].held) continue;
    const Eigen::VectorXd step = relaxation * full_step;
    graph.move(state, step, graph.states[static_cast<size_t>(state)].x);
    if (const auto heeded = heeded_planes_.find(state); heeded != heeded_planes_.end())
      graph.move(state, step, heeded->second);
  }
  for (auto& [state, pull] : pulls_) pull *= 1.0 - relaxation;
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
  pulls_.clear();
  heeded_planes_.clear();
  for (const int state : report.free)
    if (isPlane(state)) heeded_planes_[state] = graph.states[static_cast<size_t>(state)].x;
  if (settled_) remember();
}

// What local rounds need of the whole graph.
void RoundSolver::remember() {
  if (!heeded_planes_.empty()) {
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
