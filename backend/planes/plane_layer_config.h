#pragma once

#include "backend/planes/plane_association.h"
#include "common/config/config_io.h"

namespace sgraphs {

// Members are listed once, in visit(); see config_io.h.
struct PlaneLayerConfig {
  AssociationGate gate;
  double min_area_m2 = 0.5;
  int patience_keyframes = 30;
  double shared_information = 10.0;
  double level_sigma_rad = 0.002;
  double plumb_sigma_rad = 0.004;
  double parallel_sigma_rad = 0.004;
  double same_height_sigma_m = 0.01;

  void visit(ConfigVisitor& v) {
    v.field("surface_m", gate.surface_m, 0.0, 0.1, "How far real walls depart from planes, offset");
    v.field("surface_rad", gate.surface_rad, 0.0, 0.1, "How far real walls depart from planes, direction");
    v.field("gate_chi2", gate.chi2, 1.0, 100.0, "Association: chi-square with 3 degrees of freedom");
    v.field("ambiguity_chi2", gate.ambiguity, 0.0, 100.0, "Association: a rival must be worse by this");
    v.field("max_gap_m", gate.max_gap_m, 0.0, 10.0, "Association: gap within one face; doors are no ends");
    v.field("min_area_m2", min_area_m2, 0.0, 10.0, "A plane is mapped once it was seen this large");
    v.field("patience_keyframes", patience_keyframes, 1, 1000,
            "A plane is mapped if it is seen again within so many keyframes");
    v.field("shared_information", shared_information, 0.0, 1e6,
            "How much odometry by registration gives way to the planes of the same scans");
    v.field("level_sigma_rad", level_sigma_rad, 1e-5, 1.0, "How level floors and ceilings are");
    v.field("plumb_sigma_rad", plumb_sigma_rad, 1e-5, 1.0, "How plumb walls are");
    v.field("parallel_sigma_rad", parallel_sigma_rad, 1e-5, 1.0, "How parallel the two faces of a wall are");
    v.field("same_height_sigma_m", same_height_sigma_m, 1e-5, 1.0, "How even the floor of a storey is");
  }
};

}  // namespace sgraphs
