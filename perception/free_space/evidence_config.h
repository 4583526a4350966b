#pragma once

#include "common/config/config_io.h"

namespace sgraphs {

// How keyframe clouds become evidence for and against obstacles, and evidence becomes a grid seen from above.
// Members are listed once, in visit(); see config_io.h.
struct EvidenceConfig {
  double cell_m = 0.1;
  double max_range_m = 15.0;
  double misses_per_hit = 1.0;
  double misses_per_wall_hit = 25.0;
  double min_wall_length_m = 1.5;
  double min_wall_top_m = 1.0;
  double max_island_m = 1.5;
  double reach_m = 5.0;
  int keyframes_per_place = 8;

  void visit(ConfigVisitor& v) {
    v.field("cell_m", cell_m, 0.05, 0.5, "Edge of a cell");
    v.field("max_range_m", max_range_m, 2.0, 50.0,
            "Rays are followed so far: beyond, rings are too sparse and poses too rough");
    v.field("misses_per_hit", misses_per_hit, 0.1, 100.0,
            "Keyframes that must see through a place for each that saw something there: people walk on");
    v.field("misses_per_wall_hit", misses_per_wall_hit, 0.1, 1000.0,
            "The same on a mapped wall: glass is seen from in front only, and through from the side");
    v.field("min_wall_length_m", min_wall_length_m, 0.1, 10.0, "A mapped plane of this length is a wall");
    v.field("min_wall_top_m", min_wall_top_m, 0.1, 5.0,
            "A wall counts where it was seen at this height over the walking surface: desks end below");
    v.field("max_island_m", max_island_m, 0.0, 10.0,
            "What stands free and is no larger (a column, a person) does not divide rooms");
    v.field("reach_m", reach_m, 0.5, 20.0, "Clearance is computed up to this distance");
    v.field("keyframes_per_place", keyframes_per_place, 1, 1000,
            "Keyframes kept per square metre of path, the newest: bounds memory by space, not time");
  }
};

}  // namespace sgraphs
