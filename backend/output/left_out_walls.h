#pragma once

#include <set>

#include "backend/graph/situational_graph.h"

namespace sgraphs {

// Walls that rooms are made of: OUT always has them.
std::set<PlaneId> wallsOfRooms(const SituationalGraph& graph);

// The graph without these planes and without what names them.
SituationalGraph withoutPlanes(const SituationalGraph& graph, const std::set<PlaneId>& planes);

// Walls that a better one of the same storey stands in place of: within 6 cm of it and 6 degrees, more than
// half of them in front of or behind it, seen less often, and not of a room. Sights of a wall together with
// a pane in its window or a jamb give a plane that lies across the wall, 2 to 5 degrees turned: no gate of
// association may take it for the wall, and no building has it.
std::set<PlaneId> copiesOfWalls(const SituationalGraph& graph);

}  // namespace sgraphs
