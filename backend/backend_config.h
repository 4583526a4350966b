#pragma once

#include "backend/loops/loop_layer_config.h"
#include "backend/planes/plane_layer_config.h"
#include "backend/rooms/room_layer_config.h"
#include "common/config/config_io.h"

namespace sgraphs {

// Members are listed once, in visit(); see config_io.h.
struct BackendConfig {
  int max_iterations = 10;
  PlaneLayerConfig planes;
  LoopLayerConfig loops;
  RoomLayerConfig rooms;
  FloorLayerConfig floors;

  void visit(ConfigVisitor& v) {
    v.field("max_iterations", max_iterations, 1, 100, "Ceres iterations of one round at most");
    v.section("planes", planes, "Walls, floors and ceilings: association and what is known of them");
    v.section("loops", loops, "Returns to a place: which of them have a part in the graph");
    v.section("rooms", rooms, "Rooms: what their walls have to do with each other");
    v.section("floors", floors, "Storeys");
  }
};

}  // namespace sgraphs
