#include "backend/solver/state_graph.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace sgraphs {

using RowMajorMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor, kMaxResiduals, kMaxCoordinates>;

int StateGraph::addState(StateKind kind) {
  states.emplace_back().kind = kind;
  return static_cast<int>(states.size()) - 1;
}

int StateGraph::addFactor(Factor factor) {
  checkStates(factor);
  const int id = static_cast<int>(factors.size());
  factors.push_back(std::move(factor));
  attach(id);
  return id;
}

void StateGraph::checkStates(const Factor& factor) const {
  const std::vector<int>& ids = factor.states;
  const auto& sizes = factor.cost->parameter_block_sizes();
  bool fits = ids.size() == sizes.size() && ids.size() <= kMaxStates;
  for (size_t i = 0; fits && i < ids.size(); ++i)
    fits = manifold(states.at(static_cast<size_t>(ids[i])).kind).AmbientSize() == sizes[i] &&
           std::count(ids.begin(), ids.end(), ids[i]) == 1;
  if (!fits) throw std::logic_error("solver: states do not fit the factor's cost, or one comes twice");
}

void StateGraph::attach(int factor) {
  for (const int state : factors[static_cast<size_t>(factor)].states) {
    std::vector<int>& of_state = states[static_cast<size_t>(state)].factors;
    of_state.insert(std::upper_bound(of_state.begin(), of_state.end(), factor), factor);
  }
}

void StateGraph::detach(int factor) {
  for (const int state : factors[static_cast<size_t>(factor)].states)
    std::erase(states[static_cast<size_t>(state)].factors, factor);
}

void StateGraph::setEnabled(int factor, bool enabled) {
  Factor& f = factors.at(static_cast<size_t>(factor));
  if (f.enabled == enabled) return;
  f.enabled = enabled;
  if (enabled)
    attach(factor);
  else
    detach(factor);
}

void StateGraph::rebind(int factor, int from, int to) {
  Factor& f = factors.at(static_cast<size_t>(factor));
  const auto slot = std::find(f.states.begin(), f.states.end(), from);
  if (slot == f.states.end() ||
      states.at(static_cast<size_t>(from)).kind != states.at(static_cast<size_t>(to)).kind)
    throw std::logic_error("solver: the factor has no such state, or the other is of another kind");
  if (from == to) return;
  if (std::find(f.states.begin(), f.states.end(), to) != f.states.end())
    throw std::logic_error("solver: the factor has that state already; disable it instead");
  if (f.enabled) detach(factor);
  *slot = to;
  if (f.enabled) attach(factor);
}

const ceres::Manifold& StateGraph::manifold(StateKind kind) const {
  if (kind == StateKind::kPose) return pose_manifold_;
  if (kind == StateKind::kPlane) return plane_manifold_;
  if (kind == StateKind::kUnitVector) return unit_vector_manifold_;
  if (kind == StateKind::kCenter) return center_manifold_;
  return height_manifold_;
}

ceres::Manifold* StateGraph::manifold(StateKind kind) {
  return const_cast<ceres::Manifold*>(&std::as_const(*this).manifold(kind));
}

double StateGraph::chi2(int factor) const {
  const Factor& f = factors[static_cast<size_t>(factor)];
  std::vector<const double*> x;
  for (const int state : f.states) x.push_back(states[static_cast<size_t>(state)].x.data());
  SmallVector residual(f.cost->num_residuals());
  f.cost->Evaluate(x.data(), residual.data(), nullptr);
  return residual.squaredNorm();
}

Linearised StateGraph::linearise(int factor, int only) const {
  const Factor& f = factors[static_cast<size_t>(factor)];
  Linearised out;
  out.residual.resize(f.cost->num_residuals());
  std::array<RowMajorMatrix, kMaxStates> ambient;
  std::array<const double*, kMaxStates> x{};
  std::array<double*, kMaxStates> jacobians{};
  for (size_t i = 0; i < f.states.size(); ++i) {
    x[i] = states[static_cast<size_t>(f.states[i])].x.data();
    if (only >= 0 && f.states[i] != only) continue;
    ambient[i].resize(f.cost->num_residuals(), f.cost->parameter_block_sizes()[i]);
    jacobians[i] = ambient[i].data();
  }
  f.cost->Evaluate(x.data(), out.residual.data(), jacobians.data());

  double weight = 1.0;
  if (f.loss) {
    std::array<double, 3> rho{};
    f.loss->Evaluate(out.residual.squaredNorm(), rho.data());
    weight = std::sqrt(rho[1]);
  }
  out.residual *= weight;
  for (size_t i = 0; i < f.states.size(); ++i) {
    if (jacobians[i] == nullptr) continue;
    const ceres::Manifold& m = manifold(states[static_cast<size_t>(f.states[i])].kind);
    RowMajorMatrix plus(m.AmbientSize(), m.TangentSize());
    m.PlusJacobian(x[i], plus.data());
    out.jacobians[i] = weight * ambient[i] * plus;
  }
  return out;
}

NormalEquations StateGraph::normalEquations(int state) const {
  const State& s = states[static_cast<size_t>(state)];
  const int n = manifold(s.kind).TangentSize();
  NormalEquations sum{Eigen::MatrixXd::Zero(n, n), Eigen::VectorXd::Zero(n)};
  for (const int id : s.factors) {
    const Linearised f = linearise(id, state);
    for (const SmallMatrix& J : f.jacobians) {
      if (J.size() == 0) continue;
      sum.H += J.transpose() * J;
      sum.g += J.transpose() * f.residual;
    }
  }
  return sum;
}

StepSize StateGraph::newtonStep(int state) const {
  const NormalEquations normal = normalEquations(state);
  // A direction that no factor holds has no gradient either: the pseudo-inverse leaves it alone.
  return sizeOf(state, normal.H.completeOrthogonalDecomposition().solve(normal.g));
}

void StateGraph::move(int state, const Eigen::VectorXd& step, std::array<double, 7>& x) const {
  const std::array<double, 7> before = x;
  manifold(states[static_cast<size_t>(state)].kind).Plus(before.data(), step.data(), x.data());
}

Eigen::VectorXd StateGraph::difference(int state, const std::array<double, 7>& x) const {
  const State& s = states[static_cast<size_t>(state)];
  Eigen::VectorXd step(manifold(s.kind).TangentSize());
  // In the axes at the present value, as Jacobians are: those of a wall flip where its normal's z changes
  // sign.
  manifold(s.kind).Minus(x.data(), s.x.data(), step.data());
  return -step;
}

StepSize StateGraph::sizeOf(int state, const Eigen::VectorXd& step) const {
  if (states[static_cast<size_t>(state)].kind == StateKind::kPose)
    return {step.head<3>().norm(), step.tail<3>().norm()};
  if (states[static_cast<size_t>(state)].kind == StateKind::kPlane)
    return {std::abs(step(2)), step.head<2>().norm()};
  if (follows(states[static_cast<size_t>(state)].kind)) return {step.norm(), 0.0};
  return {0.0, step.norm()};
}

}  // namespace sgraphs
