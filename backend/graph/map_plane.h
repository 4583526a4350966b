#pragma once

#include "backend/graph/situational_graph.h"

namespace sgraphs {

// A plane as other stages are told of it.
MapPlane mapPlane(const PlaneNode& node);

// Merges follow one another: the plane that stands at their end, which is `id` if it was not merged. Throws
// std::logic_error for planes merged in a circle.
PlaneId livesOnIn(const SituationalGraph& graph, PlaneId id);
// The same, but invalid if that plane is no node of the graph.
PlaneId livingPlane(const SituationalGraph& graph, PlaneId id);

}  // namespace sgraphs
