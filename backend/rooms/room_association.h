#pragma once

#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "backend/graph/situational_graph.h"

namespace sgraphs {

// Two rooms of one storey that are one room seen twice, at places that drift has set apart: their walls
// correspond one to one, facing the same way and as far from the room's own centre, and the centres are
// nearer than max_apart_m and than a third of the room's least width. Pairs (wall of a, wall of b), in the
// order of a's walls; none if they are different rooms, or too few walls say so.
std::optional<std::vector<std::pair<PlaneId, PlaneId>>> wallsOfSameRoom(
    const RoomObservation& a, const RoomObservation& b, const std::map<PlaneId, PlaneNode>& planes,
    double max_apart_m);

}  // namespace sgraphs
