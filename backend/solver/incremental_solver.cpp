#include "backend/solver/incremental_solver.h"

#include <algorithm>

#include "backend/solver/round_solver.h"

namespace sgraphs {

class IncrementalSolver::Impl : public RoundSolver {
 public:
  using RoundSolver::RoundSolver;

  // A changed factor of what follows others moves nothing but that.
  void markFactor(const std::vector<StateId>& states) {
    std::vector<StateId> marked;
    for (const StateId state : states)
      if (follows(graph.states[static_cast<size_t>(state)].kind)) marked.push_back(state);
    markChanged(marked.empty() ? states : marked);
  }

  template <typename Covariance>
  std::map<StateId, Covariance> covariancesOf(StateKind kind) {
    std::map<StateId, Covariance> out;
    const std::vector<Eigen::MatrixXd> all = marginals().allCovariances();
    for (size_t i = 0; i < all.size(); ++i)
      if (graph.states[i].kind == kind) out.emplace(static_cast<StateId>(i), all[i]);
    return out;
  }
};

IncrementalSolver::IncrementalSolver(const SolverOptions& options) : impl_(std::make_unique<Impl>(options)) {}
IncrementalSolver::~IncrementalSolver() = default;

IncrementalSolver::StateId IncrementalSolver::addPose(const SE3& T) {
  const StateId id = impl_->graph.addState(StateKind::kPose);
  PoseManifold::store(T, impl_->graph.states.back().x.data());
  impl_->forgetMarginals();
  return id;
}

IncrementalSolver::StateId IncrementalSolver::addPlane(const PlaneState& plane) {
  const StateId id = impl_->graph.addState(StateKind::kPlane);
  PlaneManifold::store(plane, impl_->graph.states.back().x.data());
  impl_->forgetMarginals();
  return id;
}

IncrementalSolver::StateId IncrementalSolver::addSharedUnitVector(const Eigen::Vector3d& n) {
  const StateId id = impl_->graph.addState(StateKind::kUnitVector);
  impl_->graph.states.back().shared = true;
  setUnitVector(id, n);
  return id;
}

IncrementalSolver::StateId IncrementalSolver::addCenter(const Eigen::Vector2d& center) {
  const StateId id = impl_->graph.addState(StateKind::kCenter);
  std::copy_n(center.data(), 2, impl_->graph.states.back().x.begin());
  impl_->forgetMarginals();
  return id;
}

IncrementalSolver::StateId IncrementalSolver::addHeight(double height_m) {
  const StateId id = impl_->graph.addState(StateKind::kHeight);
  impl_->graph.states.back().x[0] = height_m;
  impl_->forgetMarginals();
  return id;
}

void IncrementalSolver::hold(StateId state) {
  impl_->graph.states.at(static_cast<size_t>(state)).held = true;
}

IncrementalSolver::FactorId IncrementalSolver::addFactor(std::unique_ptr<ceres::CostFunction> cost,
                                                         const std::vector<StateId>& states,
                                                         std::optional<double> cauchy_scale) {
  Factor factor;
  factor.cost = std::move(cost);
  if (cauchy_scale) factor.loss = std::make_unique<ceres::CauchyLoss>(*cauchy_scale);
  factor.states = states;
  const FactorId id = impl_->graph.addFactor(std::move(factor));
  impl_->markFactor(states);
  return id;
}

void IncrementalSolver::setEnabled(FactorId factor, bool enabled) {
  if (this->enabled(factor) == enabled) return;
  impl_->graph.setEnabled(factor, enabled);
  impl_->markFactor(impl_->graph.factors[static_cast<size_t>(factor)].states);
}

bool IncrementalSolver::enabled(FactorId factor) const {
  return impl_->graph.factors.at(static_cast<size_t>(factor)).enabled;
}

void IncrementalSolver::rebind(FactorId factor, StateId from, StateId to) {
  impl_->graph.rebind(factor, from, to);
  if (!enabled(factor)) return;
  std::vector<StateId> states = impl_->graph.factors[static_cast<size_t>(factor)].states;
  states.push_back(from);
  impl_->markFactor(states);
}

SE3 IncrementalSolver::pose(StateId state) const {
  return PoseManifold::load(impl_->graph.states.at(static_cast<size_t>(state)).x.data());
}

void IncrementalSolver::setPose(StateId state, const SE3& T) {
  impl_->forgetWhole();
  PoseManifold::store(T, impl_->graph.states.at(static_cast<size_t>(state)).x.data());
}

PlaneState IncrementalSolver::plane(StateId state) const {
  return PlaneManifold::load(impl_->graph.states.at(static_cast<size_t>(state)).x.data());
}

void IncrementalSolver::setPlane(StateId state, const PlaneState& plane) {
  impl_->forgetWhole();
  PlaneManifold::store(plane, impl_->graph.states.at(static_cast<size_t>(state)).x.data());
}

Eigen::Vector3d IncrementalSolver::unitVector(StateId state) const {
  return Eigen::Vector3d(impl_->graph.states.at(static_cast<size_t>(state)).x.data());
}

void IncrementalSolver::setUnitVector(StateId state, const Eigen::Vector3d& n) {
  impl_->forgetWhole();
  std::copy_n(n.data(), 3, impl_->graph.states.at(static_cast<size_t>(state)).x.begin());
}

Eigen::Vector2d IncrementalSolver::center(StateId state) const {
  return Eigen::Vector2d(impl_->graph.states.at(static_cast<size_t>(state)).x.data());
}

double IncrementalSolver::height(StateId state) const {
  return impl_->graph.states.at(static_cast<size_t>(state)).x[0];
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
