#pragma once

#include <vector>

#include "backend/graph/situational_graph.h"
#include "backend/output/map_cloud.h"

namespace sgraphs {

// Drops from the map what was there for a moment only: people walking. A point goes where rays of at least
// three keyframes passed through its place (0.1 m wide, 0.2 m high) and more than three for each keyframe
// that saw something there; never on a mapped wall, and never below 0.1 m or above 1.7 m over the walking
// surface. How well a point agrees with others plays no part in it.
void dropWhatMovedAway(const SituationalGraph& graph, std::vector<MapPoint>& map);

}  // namespace sgraphs
