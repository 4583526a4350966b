#pragma once

#include <vector>

#include "common/types/rooms.h"
#include "perception/rooms/storey_tracker.h"
#include "perception/rooms/wall_candidates.h"
#include "perception/rooms/wall_map.h"

namespace sgraphs {

// The storeys with their heights, from the level planes under the path, and their centres, from their walls.
// Where no plane was seen, the height follows from the body's above storeys whose planes were.
std::vector<FloorObservation> floorsOf(const WallMap& map, const StoreyTracker& storeys);

// Height to look for walls above: of the walking surface, else a guess below the body.
double surfaceOf(const FloorObservation& floor, const StoreyTracker& storeys);

}  // namespace sgraphs
