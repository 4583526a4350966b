#include "backend/solver/marginal_covariance.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <functional>

#include "common/geometry/tangent_basis.h"

namespace sgraphs {
namespace {

// Lower triangle of J^T J.
Eigen::SparseMatrix<double> information(const StateGraph& graph, const std::vector<int>& columns, int size) {
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(graph.factors.size() * 100);
  for (size_t f = 0; f < graph.factors.size(); ++f) {
    if (!graph.factors[f].enabled) continue;
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

// The entries of (L L^T)^-1 at the places where L has entries, column by column from the last (Takahashi,
// Fagan and Chin, 1973). With Z = L^-T L^-1, Z L = L^-T is upper triangular, hence for i > j
//   Z_ij = -sum_{k > j} Z_ik L_kj / L_jj,   Z_jj = (1 / L_jj - sum_{k > j} L_kj Z_kj) / L_jj
// where k runs over the entries of column j, and every Z_ik asked for lies on an entry of L: the rows of a
// column form a clique of the factor.
class SparseInverse {
 public:
  explicit SparseInverse(const Eigen::SparseMatrix<double>& L)
      : Z_(L), place_(static_cast<size_t>(L.rows()), -1) {
    Z_.makeCompressed();
    for (int j = static_cast<int>(L.cols()) - 1; j >= 0; --j) column(j);
  }

  double at(int i, int j) const {
    const auto [row, column] = std::minmax(i, j, std::greater<>());
    const int* begin = Z_.innerIndexPtr() + Z_.outerIndexPtr()[column];
    const int* end = Z_.innerIndexPtr() + Z_.outerIndexPtr()[column + 1];
    return Z_.valuePtr()[std::lower_bound(begin, end, row) - Z_.innerIndexPtr()];
  }

 private:
  // Entry 0 of a column is the diagonal; columns after j hold Z already, column j still holds L.
  void column(int j) {
    const int begin = Z_.outerIndexPtr()[j];
    const int size = Z_.outerIndexPtr()[j + 1] - begin;
    const int* rows = Z_.innerIndexPtr() + begin;
    double* values = Z_.valuePtr() + begin;
    const double diagonal = values[0];
    sum_.assign(static_cast<size_t>(size), 0.0);
    for (int s = 1; s < size; ++s) place_[static_cast<size_t>(rows[s])] = s;
    for (int s = 1; s < size; ++s) addColumn(rows[s], s, values);
    double own = 0;
    for (int s = 1; s < size; ++s) {
      place_[static_cast<size_t>(rows[s])] = -1;
      const double l = values[s];
      values[s] = -sum_[static_cast<size_t>(s)] / diagonal;
      own += l * values[s];
    }
    values[0] = (1.0 / diagonal - own) / diagonal;
  }

  // Adds Z_ik L_kj for all i of column j, and by symmetry Z_ki L_ij for k = the column given.
  void addColumn(int k, int s, const double* l) {
    const int* rows = Z_.innerIndexPtr();
    for (int e = Z_.outerIndexPtr()[k]; e < Z_.outerIndexPtr()[k + 1]; ++e) {
      const int t = place_[static_cast<size_t>(rows[e])];
      if (t < 0) continue;
      const double z = Z_.valuePtr()[e];
      sum_[static_cast<size_t>(t)] += z * l[s];
      if (t != s) sum_[static_cast<size_t>(s)] += z * l[t];
    }
  }

  Eigen::SparseMatrix<double> Z_;  // lower triangle
  std::vector<int> place_;         // of a row in the present column; -1: none
  std::vector<double> sum_;
};

}  // namespace

Marginals::Marginals(const StateGraph& graph)
    : graph_(graph),
      columns_(graph.states.size(), -1),
      normals_(graph.states.size(), Eigen::Vector3d::Zero()) {
  for (size_t i = 0; i < graph.states.size(); ++i) {
    const State& state = graph.states[i];
    if (state.held || state.factors.empty()) continue;
    columns_[i] = size_;
    if (state.kind == StateKind::kPlane) normals_[i] = Eigen::Vector3d(state.x.data());
    size_ += graph.manifold(state.kind).TangentSize();
  }
  if (size_ > 0) cholesky_.compute(information(graph, columns_, size_));
}

int Marginals::tangentSize(int state) const {
  return graph_.manifold(graph_.states.at(static_cast<size_t>(state)).kind).TangentSize();
}

// The axes of a plane are a function of its normal, and flip where its z changes sign: a wall's do so often.
std::optional<Eigen::Matrix2d> Marginals::turnSince(int state) const {
  const State& s = graph_.states[static_cast<size_t>(state)];
  if (s.kind != StateKind::kPlane) return std::nullopt;
  return tangentTurn(Eigen::Vector3d(s.x.data()), normals_[static_cast<size_t>(state)]);
}

Eigen::VectorXd Marginals::toThen(int state, Eigen::VectorXd v) const {
  if (const auto turn = turnSince(state)) v.head<2>() = (*turn * v.head<2>()).eval();
  return v;
}

Eigen::VectorXd Marginals::toNow(int state, Eigen::VectorXd v) const {
  if (const auto turn = turnSince(state)) v.head<2>() = (turn->transpose() * v.head<2>()).eval();
  return v;
}

std::vector<Marginals::StateVector> Marginals::newtonSteps(
    const std::map<int, Eigen::VectorXd>& gradients) const {
  std::vector<StateVector> steps;
  if (size_ == 0 || !valid()) return steps;
  Eigen::VectorXd rhs = Eigen::VectorXd::Zero(size_);
  for (const auto& [state, gradient] : gradients) {
    if (static_cast<size_t>(state) >= columns_.size() || columns_[static_cast<size_t>(state)] < 0) continue;
    rhs.segment(columns_[static_cast<size_t>(state)], gradient.size()) = -toThen(state, gradient);
  }
  const Eigen::VectorXd solution = cholesky_.solve(rhs);
  for (size_t i = 0; i < columns_.size(); ++i) {
    const auto state = static_cast<int>(i);
    if (columns_[i] >= 0)
      steps.emplace_back(state, toNow(state, solution.segment(columns_[i], tangentSize(state))));
  }
  return steps;
}

std::optional<Eigen::MatrixXd> Marginals::covariance(int state) const {
  return covariance(std::vector<int>{state});
}

std::optional<Eigen::MatrixXd> Marginals::covariance(const std::vector<int>& states) const {
  int n = 0;
  std::vector<int> columns;  // of the whole, by row of the result; -1: held
  for (const int state : states) {
    const int first = columns_.at(static_cast<size_t>(state));
    for (int i = 0; i < tangentSize(state); ++i, ++n) columns.push_back(first < 0 ? -1 : first + i);
  }
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(n, n);
  if (std::all_of(columns.begin(), columns.end(), [](int column) { return column < 0; })) return out;
  if (cholesky_.info() != Eigen::Success) return std::nullopt;
  Eigen::MatrixXd rhs = Eigen::MatrixXd::Zero(size_, n);
  for (int i = 0; i < n; ++i)
    if (columns[static_cast<size_t>(i)] >= 0) rhs(columns[static_cast<size_t>(i)], i) = 1.0;
  const Eigen::MatrixXd solution = cholesky_.solve(rhs);
  for (int i = 0; i < n; ++i)
    if (columns[static_cast<size_t>(i)] >= 0) out.row(i) = solution.row(columns[static_cast<size_t>(i)]);
  return Eigen::MatrixXd(0.5 * (out + out.transpose()));
}

std::vector<Eigen::MatrixXd> Marginals::allCovariances() const {
  std::vector<Eigen::MatrixXd> out;
  if (size_ > 0 && cholesky_.info() != Eigen::Success) return out;
  std::optional<SparseInverse> inverse;
  if (size_ > 0) inverse.emplace(cholesky_.matrixL().nestedExpression());
  const auto& order = cholesky_.permutationP().indices();
  for (size_t s = 0; s < columns_.size(); ++s) {
    const int n = tangentSize(static_cast<int>(s));
    Eigen::MatrixXd& block = out.emplace_back(Eigen::MatrixXd::Zero(n, n));
    if (columns_[s] < 0) continue;
    for (int r = 0; r < n; ++r)
      for (int c = 0; c <= r; ++c)
        block(r, c) = block(c, r) = inverse->at(order[columns_[s] + r], order[columns_[s] + c]);
  }
  return out;
}

}  // namespace sgraphs
