#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "backend/graph_builder.h"
#include "backend/planes/plane_layer.h"
#include "backend/rooms/room_layer_config.h"
#include "backend/rooms/room_shape.h"

namespace sgraphs {

// Rooms and doorways of the graph: nodes and factors as the newest observation has them, and rooms seen
// twice made one. What was bound before is read from the graph alone; no room leaves a trace in another.
class RoomLayer {
 public:
  RoomLayer(const RoomLayerConfig& config, GraphBuilder& builder, PlaneLayer& planes)
      : config_(config), builder_(builder), planes_(planes) {}

  struct Outcome {
    bool merged = false;               // walls became one: its effect is not local
    std::vector<std::string> refused;  // one line for each thing that cannot be
  };
  // The observation is complete: rooms and doorways that are not in it are withdrawn. Its storeys must be in
  // the graph.
  Outcome apply(const Rooms& rooms);

 private:
  using RoomPair = std::pair<RoomId, RoomId>;

  std::vector<RoomObservation> usable(const Rooms& rooms, std::vector<std::string>& refused) const;
  void resolve(RoomObservation& room) const;
  bool mergeDuplicates(std::vector<RoomObservation>& seen);
  void mergeWalls(const std::vector<std::pair<PlaneId, PlaneId>>& matches);
  void absorb(std::vector<RoomObservation>& seen);
  void withdraw(const std::vector<RoomObservation>& seen);
  void bind(const RoomObservation& room);
  void bindShapes();
  void putDoorways(const std::vector<Doorway>& doorways);
  KeyframeId anchorOf(const RoomObservation& room) const;

  RoomLayerConfig config_;
  GraphBuilder& builder_;
  PlaneLayer& planes_;
  HeadingEvidence headings_;
  std::map<RoomPair, int> twins_;    // rounds in a row that took the two for one
  std::map<RoomId, RoomId> one_of_;  // a room seen twice, by the id of its later sight
};

}  // namespace sgraphs
