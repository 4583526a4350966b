#pragma once

#include "common/config/config_io.h"

namespace sgraphs {

// Members are listed once, in visit(); see config_io.h.
struct RoomsConfig {
  int window_keyframes = 0;
  double furniture_depth_m = 0.8;
  double boundary_cost_m = 0.3;
  double min_area_m2 = 1.2;
  double min_width_m = 0.8;
  double max_frontier_share = 0.2;
  double min_wall_share = 0.6;
  double opposed_rad = 0.09;
  int stable_rounds = 2;
  int patience_rounds = 5;
  double climb_slope = 0.15;
  double same_storey_m = 1.0;

  void visit(ConfigVisitor& v) {
    v.field("window_keyframes", window_keyframes, 0, 1000000,
            "Rooms are made of walls that changed within so many keyframes; 0: of all");
    v.field("furniture_depth_m", furniture_depth_m, 0.0, 3.0,
            "A wall may stand so far behind the border of free space: cabinets hide it");
    v.field("boundary_cost_m", boundary_cost_m, 0.0, 10.0,
            "Area in doubt that is worth a metre of outline without a wall");
    v.field("min_area_m2", min_area_m2, 0.1, 100.0, "Smaller rooms are none: a closet is one");
    v.field("min_width_m", min_width_m, 0.1, 10.0, "Opposed walls of a room are so far apart");
    v.field("max_frontier_share", max_frontier_share, 0.0, 1.0,
            "Share of the border that nobody has looked behind, at most; half of it in rooms open at an end, "
            "twice in closed ones");
    v.field("min_wall_share", min_wall_share, 0.0, 1.0, "Share of the outline with a wall, at least");
    v.field("opposed_rad", opposed_rad, 0.001, 0.7, "Opposed walls are parallel to within this");
    v.field("stable_rounds", stable_rounds, 1, 1000, "Rounds in a row in which a new room must look alike");
    v.field("patience_rounds", patience_rounds, 1, 1000, "A room is withdrawn if it is gone for so long");
    v.field("climb_slope", climb_slope, 0.02, 2.0,
            "Rise over distance that a robot climbs with: gait and drift give less");
    v.field("same_storey_m", same_storey_m, 0.2, 2.0, "Walking surfaces this close in height are one storey");
  }
};

}  // namespace sgraphs
