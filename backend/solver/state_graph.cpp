#include "backend/solver/state_graph.h"

#include <Eigen/Dense>
#include <cmath>

namespace sgraphs {

using RowMajorMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor, kMaxResiduals, kMaxCoordinates>;

int StateGraph::addState(StateKind kind) {
  states.emplace_back().kind = kind;
  return static_cast<int>(states.size()) - 1;
}

int StateGraph::addFactor(Factor factor) {
  const int id = static_cast<int>(factors.size());
  for (const int state : factor.states) states.at(static_cast<size_t>(state)).factors.push_back(id);
  factors.push_back(std::move(factor));
  return id;
}

const ceres::Manifold& StateGraph::manifold(StateKind kind) const {
  if (kind == StateKind::kPose) return pose_manifold_;
  return unit_vector_manifold_;
}

ceres::Manifold* StateGraph::manifold(StateKind kind) {
  if (kind == StateKind::kPose) return &pose_manifold_;
  return &unit_vector_manifold_;
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
  out.jacobians.resize(f.states.size());
  std::vector<RowMajorMatrix> ambient(f.states.size());
  std::vector<const double*> x;
  std::vector<double*> jacobians(f.states.size(), nullptr);
  for (size_t i = 0; i < f.states.size(); ++i) {
    x.push_back(states[static_cast<size_t>(f.states[i])].x.data());
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

StepSize StateGraph::sizeOf(int state, const Eigen::VectorXd& step) const {
  if (states[static_cast<size_t>(state)].kind == StateKind::kPose)
    return {step.head<3>().norm(), step.tail<3>().norm()};
  return {0.0, step.norm()};
}

}  // namespace sgraphs
