#pragma once

#include "common/config/config_io.h"

namespace sgraphs {

// Members are listed once, in visit(); see config_io.h. `replay --layers rooms` is floors.factors=false,
// `--layers walls` both false.
struct RoomLayerConfig {
  bool factors = true;
  double wall_sigma_m = 0.02;
  double along_sigma_m = 0.5;
  double shape_sigma_rad = 0.005;
  double same_center_m = 1.0;

  void visit(ConfigVisitor& v) {
    v.field("factors", factors, "Rooms are part of the optimised graph; else they are only reported");
    v.field("wall_sigma_m", wall_sigma_m, 1e-4, 1.0, "How true walls are built: of a room's centre");
    v.field("along_sigma_m", along_sigma_m, 1e-3, 100.0, "Place of a corridor's centre along it");
    v.field("shape_sigma_rad", shape_sigma_rad, 1e-5, 0.1, "How square rooms are built: two of its walls");
    v.field("same_center_m", same_center_m, 0.0, 10.0,
            "Rooms of one shape whose centres are nearer are one room seen twice: the drift that this mends");
  }
};

struct FloorLayerConfig {
  bool factors = true;
  double height_sigma_m = 0.01;

  void visit(ConfigVisitor& v) {
    v.field("factors", factors, "Storeys are part of the optimised graph; else they are only reported");
    v.field("height_sigma_m", height_sigma_m, 1e-4, 1.0, "How even the floor of a storey is");
  }
};

}  // namespace sgraphs
