#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "backend/backend.h"
#include "sgraphs/graph_update_t.hpp"

namespace sgraphs {

// GRAPH_UPDATE of a round: the keyframes and planes that it changed, and all rooms and floors if any of them
// changed, in chunks that fit one datagram. A plane that was merged away says which living plane it is now.
// `idle`: the round had no keyframe. Throws std::logic_error for a changed node that the
// graph does not know.
std::vector<graph_update_t> updateMessages(const SituationalGraph& graph, const RoundOutput& output,
                                           int64_t round, Time time, bool idle);

// GRAPH_SNAPSHOT: every node, and where each merged plane lives on.
std::vector<graph_update_t> snapshotMessages(const SituationalGraph& graph, const RoundOutput& newest,
                                             int64_t round, Time time);

}  // namespace sgraphs
