#pragma once

#include <nlohmann/json.hpp>

#include "backend/graph/situational_graph.h"
#include "backend/output/session_clock.h"

namespace sgraphs {

// The layers above the walls, and the free space below all, as graph.json has them (contract.md). Rooms carry
// the sensor time at which they were accepted as "utime", and in a map of several sessions the one it was in.
// A doorway into something that is no room leads to the nearest vertex of free space there.
void addUpperLayerNodes(const SituationalGraph& graph, std::span<const SessionClock> sessions,
                        nlohmann::ordered_json& nodes);
void addUpperLayerLinks(const SituationalGraph& graph, nlohmann::ordered_json& links);

}  // namespace sgraphs
