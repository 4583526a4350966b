#pragma once

#include "backend/solver/state_graph.h"

namespace sgraphs {

// The diagonal block of the inverse of J^T J that belongs to `state`; all states but the held ones are free.
// Throws std::logic_error if J^T J is singular. Zero for a held state.
Eigen::MatrixXd marginalCovariance(const StateGraph& graph, int state);

}  // namespace sgraphs
