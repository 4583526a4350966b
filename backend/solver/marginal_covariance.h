#pragma once

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "backend/solver/state_graph.h"

namespace sgraphs {

// J^T J of the whole graph at its present states, factorised: all states but the held ones are free.
class Marginals {
 public:
  using StateVector = std::pair<int, Eigen::VectorXd>;  // a state and a vector of its tangent

  explicit Marginals(const StateGraph& graph);

  // False: J^T J is singular.
  bool valid() const { return cholesky_.info() == Eigen::Success; }
  // States there were; later ones are unknown here.
  size_t numStates() const { return columns_.size(); }
  // Of all free states the steps -(J^T J)^-1 g, for the gradients of some; those of unknown or held states do
  // not count.
  std::vector<StateVector> newtonSteps(const std::map<int, Eigen::VectorXd>& gradients) const;

  // The diagonal block of the inverse that belongs to the state: its covariance. Zero for a held state, none
  // if J^T J is singular.
  std::optional<Eigen::MatrixXd> covariance(int state) const;
  // The joint covariance of several states, in blocks in the order given.
  std::optional<Eigen::MatrixXd> covariance(const std::vector<int>& states) const;
  // covariance(state) of every state, in about the time of the factorisation. Empty if J^T J is singular.
  std::vector<Eigen::MatrixXd> allCovariances() const;

 private:
  int tangentSize(int state) const;
  // Takes a tangent vector of the state from its present axes to those of the factorisation.
  Eigen::VectorXd toThen(int state, Eigen::VectorXd v) const;
  Eigen::VectorXd toNow(int state, Eigen::VectorXd v) const;
  std::optional<Eigen::Matrix2d> turnSince(int state) const;

  const StateGraph& graph_;
  std::vector<int> columns_;              // first column of each state; -1: held, or without a factor
  std::vector<Eigen::Vector3d> normals_;  // of planes at the factorisation, by state
  int size_ = 0;
  Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> cholesky_;
};

}  // namespace sgraphs
