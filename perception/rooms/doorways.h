#pragma once

#include <map>
#include <vector>

#include "common/types/free_space.h"
#include "perception/rooms/room_tracker.h"
#include "perception/rooms/wall_map.h"

namespace sgraphs {

// The passages that lead from one room into another, or from a room into what is none yet, by id. A doorway
// stands in the middle of its wall if both faces are known.
std::vector<Doorway> doorwaysOf(const std::map<PassageId, Passage>& passages, const RoomTracker& rooms,
                                const std::map<PlaneId, Wall>& walls);

}  // namespace sgraphs
