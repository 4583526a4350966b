#include "perception/loops/loops_config.h"

namespace sgraphs {

void LoopGateConfig::visit(ConfigVisitor& v) {
  v.field("base_m", base_m, 0.0, 10.0, "Radius of the search at a place just left");
  v.field("base_rad", base_rad, 0.0, 3.2, "The same of the heading");
  v.field("registered_share", registered_share, 0.0, 1.0,
          "Grows by this share of the path where poses were registered");
  v.field("legs_share", legs_share, 0.0, 1.0, "The same where the legs alone measured the path");
  v.field("registered_rad_per_m", registered_rad_per_m, 0.0, 1.0, "The heading's growth, registered");
  v.field("legs_rad_per_m", legs_rad_per_m, 0.0, 1.0, "The heading's growth by the legs");
  v.field("sigmas", sigmas, 0.0, 100.0,
          "Standard deviations of the composed odometry that are added; it is overconfident");
  v.field("max_m", max_m, 0.5, 100.0, "Largest radius of the search");
  v.field("max_rad", max_rad, 0.05, 3.2, "Largest difference of headings looked for");
  v.field("height_m", height_m, 0.1, 10.0, "Largest difference of heights; storeys are farther apart");
  v.field("min_walked_m", min_walked_m, 1.0, 1000.0, "A place left less path ago is no return");
}

void LoopVerificationConfig::visit(ConfigVisitor& v) {
  v.field("submap_radius_m", submap_radius_m, 1.0, 100.0, "Reach of the old surroundings registered against");
  v.field("submap_path_m", submap_path_m, 0.0, 1000.0,
          "Path before and behind an old place that makes up its surroundings");
  v.field("query_path_m", query_path_m, 0.0, 100.0,
          "Path behind the robot whose clouds are registered at once");
  v.field("min_overlap", min_overlap, 0.0, 1.0,
          "Share of a cloud's patches that the other's keyframes must be able to show");
  v.field("min_inlier_share", min_inlier_share, 0.0, 1.0,
          "Share of the patches in the old surroundings' field that must lie on their surfaces");
  v.field("max_conflict_share", max_conflict_share, 0.0, 1.0,
          "Share of what is seen from both that may stand where the other saw through");
  v.field("min_fit_share", min_fit_share, 0.0, 1.0,
          "Share of the overlap that must meet the old surfaces within the noise");
  v.field("max_sigma_m", max_sigma_m, 0.001, 10.0,
          "A loop whose place is known worse than this in any direction is refused: a bare corridor");
  v.field("max_sigma_rad", max_sigma_rad, 0.0001, 1.0, "The same of its rotation");
  v.field("rival_margin", rival_margin, 0.0, 1.0,
          "Another place whose quality comes this close makes the loop ambiguous");
  v.field("max_hypotheses", max_hypotheses, 1, 50, "Registrations per round at most");
  v.field("covariance_scale", covariance_scale, 0.1, 1e4, "Factor on the registration's covariance");
  v.field("floor_m", floor_m, 0.0, 1.0, "Added to it in quadrature: the old map's own distortion");
  v.field("floor_rad", floor_rad, 0.0, 1.0, "Added to it in quadrature");
}

void LoopsConfig::visit(ConfigVisitor& v) {
  v.field("enabled", enabled, "Loops are looked for");
  v.field("spacing_m", spacing_m, 0.0, 1000.0, "Path between two loops at least");
  v.field("search_spacing_m", search_spacing_m, 0.0, 1000.0, "Path between two searches at least");
  v.field("place_spacing_m", place_spacing_m, 0.1, 10.0, "Distance between remembered places");
  v.field("rival_memory_m", rival_memory_m, 0.0, 1000.0,
          "Path over which a place that could have been another speaks against a loop");
  v.field("likely_share", likely_share, 0.0, 1.0,
          "A first loop that corrects more than this share of the gate waits for a second one");
  v.section("gate", gate, "Where returns are looked for");
  v.section("verification", verification, "What proves a return");
}

}  // namespace sgraphs
