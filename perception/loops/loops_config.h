#pragma once

#include "common/config/config_io.h"

namespace sgraphs {

// How far off the map's pose of a place may be that was left some path ago.
struct LoopGateConfig {
  double base_m = 0.5;
  double base_rad = 0.05;
  double registered_share = 0.01;
  double legs_share = 0.05;
  double registered_rad_per_m = 0.0005;
  double legs_rad_per_m = 0.004;
  double sigmas = 4.0;
  double max_m = 12.0;
  double max_rad = 1.0;
  double height_m = 0.8;
  double min_walked_m = 10.0;

  void visit(ConfigVisitor& v);
};

// When a registration proves that two clouds show one place.
struct LoopVerificationConfig {
  double submap_radius_m = 12.0;
  double submap_path_m = 15.0;
  double query_path_m = 4.0;
  double min_overlap = 0.35;
  double min_inlier_share = 0.85;
  double max_conflict_share = 0.03;
  double min_fit_share = 0.5;
  double max_sigma_m = 0.10;
  double max_sigma_rad = 0.02;
  double rival_margin = 0.08;
  int max_hypotheses = 6;
  double covariance_scale = 4.0;
  double floor_m = 0.007;
  double floor_rad = 0.0015;

  void visit(ConfigVisitor& v);
};

// Members are listed once, in visit(); see config_io.h.
struct LoopsConfig {
  bool enabled = true;
  double spacing_m = 4.0;
  double search_spacing_m = 1.0;
  double place_spacing_m = 0.8;
  double rival_memory_m = 20.0;
  double likely_share = 0.10;
  LoopGateConfig gate;
  LoopVerificationConfig verification;

  void visit(ConfigVisitor& v);
};

}  // namespace sgraphs
