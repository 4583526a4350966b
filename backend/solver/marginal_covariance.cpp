#include "backend/solver/marginal_covariance.h"

namespace sgraphs {
namespace {

// Lower triangle of J^T J.
Eigen::SparseMatrix<double> information(const StateGraph& graph, const std::vector<int>& columns, int size) {
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(graph.factors.size() * 100);
  for (size_t f = 0; f < graph.factors.size(); ++f) {
    const Linearised linear = graph.linearise(static_cast<int>(f));
    const std::vector<int>& states = graph.factors[f].states;
    for (size_t a = 0; a < states.size(); ++a) {
      for (size_t b = 0; b < states.size(); ++b) {
        const int row = columns[static_cast<size_t>(states[a])];
        const int column = columns[static_cast<size_t>(states[b])];
        if (row < 0 || column < 0 || row < column) continue;
        const SmallMatrix block = linear.jacobians[a].transpose() * linear.jacobians[b];
        for (int c = 0; c < block.cols(); ++c)
          for (int r = row == column ? c : 0; r < block.rows(); ++r)
            entries.emplace_back(row + r, column + c, block(r, c));
      }
    }
  }
  Eigen::SparseMatrix<double> H(size, size);
  H.setFromTriplets(entries.begin(), entries.end());
  return H;
}

}  // namespace

Marginals::Marginals(const StateGraph& graph) : graph_(graph), columns_(graph.states.size(), -1) {
  for (size_t i = 0; i < graph.states.size(); ++i) {
    const State& state = graph.states[i];
    if (state.held || state.factors.empty()) continue;
    columns_[i] = size_;
    size_ += graph.manifold(state.kind).TangentSize();
  }
  if (size_ > 0) cholesky_.compute(information(graph, columns_, size_));
}

std::optional<Eigen::MatrixXd> Marginals::covariance(int state) const {
  const int n = graph_.manifold(graph_.states.at(static_cast<size_t>(state)).kind).TangentSize();
  const int column = columns_[static_cast<size_t>(state)];
  if (column < 0) return Eigen::MatrixXd(Eigen::MatrixXd::Zero(n, n));
  if (cholesky_.info() != Eigen::Success) return std::nullopt;
  Eigen::MatrixXd rhs = Eigen::MatrixXd::Zero(size_, n);
  rhs.middleRows(column, n).setIdentity();
  const Eigen::MatrixXd block = cholesky_.solve(rhs).middleRows(column, n);
  return Eigen::MatrixXd(0.5 * (block + block.transpose()));
}

}  // namespace sgraphs
