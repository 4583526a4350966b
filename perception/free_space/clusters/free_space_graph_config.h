#pragma once

#include "common/config/config_io.h"

namespace sgraphs {

// Members are listed once, in visit(); see config_io.h. All are ratios or sizes of things that people build:
// none belongs to one building.
struct FreeSpaceGraphConfig {
  double narrow_ratio = 0.8;
  double kept_ratio = 0.87;
  double max_passage_m = 4.0;
  double min_cluster_m2 = 1.0;
  double corridor_aspect = 3.0;
  double edge_clearance_m = 0.25;
  double vertex_spacing_m = 0.8;

  void visit(ConfigVisitor& v) {
    v.field("narrow_ratio", narrow_ratio, 0.3, 1.0,
            "A passage is narrower than this share of the narrower side's widest place");
    v.field("kept_ratio", kept_ratio, 0.3, 1.0, "The same for a passage that was one in the round before");
    v.field("max_passage_m", max_passage_m, 0.5, 50.0,
            "What is wider is one room, however wide its sides are");
    v.field("min_cluster_m2", min_cluster_m2, 0.1, 20.0, "Smaller clusters join their neighbour");
    v.field("corridor_aspect", corridor_aspect, 1.5, 10.0,
            "A corridor is longer than so many of its widths; so are its straight arms");
    v.field("edge_clearance_m", edge_clearance_m, 0.0, 2.0,
            "Edges of the graph keep this distance to obstacles: half of the robot's width");
    v.field("vertex_spacing_m", vertex_spacing_m, 0.2, 5.0, "Largest distance of neighbours along the axis");
  }
};

}  // namespace sgraphs
