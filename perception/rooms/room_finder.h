#pragma once

#include <Eigen/Geometry>
#include <map>
#include <optional>
#include <vector>

#include "common/types/free_space.h"
#include "common/types/map_update.h"
#include "common/types/rooms.h"
#include "perception/rooms/floors.h"
#include "perception/rooms/room_shape.h"
#include "perception/rooms/room_tracker.h"
#include "perception/rooms/rooms_config.h"
#include "perception/rooms/storey_tracker.h"
#include "perception/rooms/wall_map.h"

namespace sgraphs {

// Rooms, doorways and floors from free space and mapped planes, round by round. Only clusters that changed,
// or walls near them, cost anything.
class RoomFinder {
 public:
  explicit RoomFinder(const RoomsConfig& config);

  // Once per round, idle ones too, in order: `update` holds what the round changed, `free_space` everything.
  Rooms step(const FreeSpace& free_space, const MapUpdate& update);

 private:
  // A cluster's room and what it was made from.
  struct Cached {
    FreeSpaceCluster cluster;
    Eigen::AlignedBox2d reach;       // walls that do not meet it cannot matter
    std::vector<int64_t> walls;      // Wall::changed of those near
    std::optional<RoomShape> shape;  // none: no room
  };

  const std::optional<RoomShape>& shapeOf(const FreeSpaceCluster& cluster, const StoreyBand& band);
  std::vector<RoomCandidate> candidatesOf(const FreeSpace& free_space,
                                          const std::vector<FloorObservation>& floors);
  bool wasEntered(const RoomShape& shape, FloorId floor) const;
  std::vector<ClusterId> unsupported() const;
  void resolveWalls();
  void placeAnchor(TrackedRoom& room) const;
  RoomObservation observationOf(const TrackedRoom& room) const;

  RoomsConfig config_;
  WallMap map_;
  StoreyTracker storeys_;
  RoomTracker tracker_;
  std::vector<FloorObservation> floors_;
  std::map<ClusterId, Cached> cache_;
};

}  // namespace sgraphs
