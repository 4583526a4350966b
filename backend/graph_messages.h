#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "backend/backend.h"
#include "sgraphs/graph_update_t.hpp"

namespace sgraphs {

// GRAPH_UPDATE of a round: the keyframes that it changed, in chunks that fit one datagram.
std::vector<graph_update_t> updateMessages(const SituationalGraph& graph, const RoundOutput& output,
                                           int64_t round, Time time);

// GRAPH_SNAPSHOT: every node.
std::vector<graph_update_t> snapshotMessages(const SituationalGraph& graph, const RoundOutput& newest,
                                             int64_t round, Time time);

}  // namespace sgraphs
