#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/types/free_space.h"
#include "common/types/loops.h"
#include "common/types/map_update.h"
#include "common/types/rooms.h"
#include "sgraphs/free_space_t.hpp"
#include "sgraphs/graph_update_t.hpp"
#include "sgraphs/loop_closures_t.hpp"
#include "sgraphs/rooms_t.hpp"

// Conversions of what goes round between backend, free space, rooms and loops; rules as in convert.h.
// Messages that are chunked are read from all chunks of a round, in order.
namespace sgraphs {

std::optional<MapUpdate> fromMessages(std::span<const graph_update_t> chunks);

// What differs between two rounds of free space. Coordinates are floats on both sides.
std::vector<free_space_t> toMessages(const FreeSpace& before, const FreeSpace& now,
                                     const std::string& why_not);
// Brings `free_space` to the message's round; false, and nothing changed, for content that cannot be right.
bool applyMessages(std::span<const free_space_t> chunks, FreeSpace& free_space);

std::vector<rooms_t> toMessages(const Rooms& rooms, const std::string& why_not);
std::optional<Rooms> fromMessages(std::span<const rooms_t> chunks);

std::vector<loop_closures_t> toMessages(const LoopClosures& loops, const std::string& why_not);
std::optional<LoopClosures> fromMessages(std::span<const loop_closures_t> chunks);

}  // namespace sgraphs
