#pragma once

#include <string>
#include <vector>

#include "backend/graph_builder.h"
#include "backend/rooms/room_layer_config.h"

namespace sgraphs {

// Storeys of the graph: which keyframes and planes are of which, their centres and heights. Factors are
// replaced where what they say has changed, and never pile up.
class FloorLayer {
 public:
  // wall_sigma_m, along_sigma_m: of centres, as for rooms.
  FloorLayer(const FloorLayerConfig& config, double wall_sigma_m, double along_sigma_m, GraphBuilder& builder)
      : config_(config), wall_sigma_m_(wall_sigma_m), along_sigma_m_(along_sigma_m), builder_(builder) {}

  // Storeys that are told of, keyframes on them, and the planes first seen from those. Returns one line for
  // each that cannot be.
  std::vector<std::string> assign(const Rooms& rooms);
  // After the rooms: centres, heights, and the rooms on them. Storeys with nothing on them that are told of
  // no more are withdrawn.
  void bind(const Rooms& rooms);

 private:
  void assignPlanes(const std::vector<KeyframeFloor>& changed);
  void bindFloor(const FloorObservation& floor);
  double bindWalls(const FloorObservation& floor);
  void bindHeight(const FloorObservation& floor);
  void bindRooms(FloorId floor, double size_m);
  void withdraw(const Rooms& rooms);

  FloorLayerConfig config_;
  double wall_sigma_m_, along_sigma_m_;
  GraphBuilder& builder_;
};

}  // namespace sgraphs
