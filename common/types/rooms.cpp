#include "common/types/rooms.h"

#include <set>

namespace sgraphs {

std::vector<PlaneId> RoomObservation::walls() const {
  std::set<PlaneId> walls;
  for (const RoomCorner& corner : polygon)
    if (corner.wall.valid()) walls.insert(corner.wall);
  for (const auto& [a, b] : pairs) walls.insert({a, b});
  return {walls.begin(), walls.end()};
}

}  // namespace sgraphs
