#pragma once

#include <optional>

#include "backend/solver/state_graph.h"

namespace sgraphs {

// The diagonal block of the inverse of J^T J that belongs to `state`; all states but the held ones are free.
// None if J^T J is singular; zero for a held state.
std::optional<Eigen::MatrixXd> marginalCovariance(const StateGraph& graph, int state);

}  // namespace sgraphs
