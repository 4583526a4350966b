#pragma once

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <optional>
#include <vector>

#include "backend/solver/state_graph.h"

namespace sgraphs {

// J^T J of the whole graph at its present states, factorised: all states but the held ones are free.
class Marginals {
 public:
  explicit Marginals(const StateGraph& graph);

  // The diagonal block of the inverse that belongs to the state: its covariance. Zero for a held state, none
  // if J^T J is singular.
  std::optional<Eigen::MatrixXd> covariance(int state) const;
  // The joint covariance of several states, in blocks in the order given.
  std::optional<Eigen::MatrixXd> covariance(const std::vector<int>& states) const;
  // covariance(state) of every state, in about the time of the factorisation. Empty if J^T J is singular.
  std::vector<Eigen::MatrixXd> allCovariances() const;

 private:
  int tangentSize(int state) const;

  const StateGraph& graph_;
  std::vector<int> columns_;  // first column of each state; -1: held, or without a factor
  int size_ = 0;
  Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> cholesky_;
};

}  // namespace sgraphs
