#pragma once

#include "backend/graph/situational_graph.h"

namespace sgraphs {

// A plane as other stages are told of it.
MapPlane mapPlane(const PlaneNode& node);

}  // namespace sgraphs
