#include "perception/planes/planes_config.h"

namespace sgraphs {

void FacetConfig::visit(ConfigVisitor& v) {
  v.field("cell_m", cell_m, 0.02, 2.0, "Edge of the cells whose points share a normal, nearest to the robot");
  v.field("cell_range_m", cell_range_m, 0.5, 100.0,
          "Beyond this range cells are twice as large, beyond twice this range again: rings spread out");
  v.field("min_points", min_points, 4, 1000, "Points that a normal needs at least");
  v.field("max_thickness_m", max_thickness_m, 0.005, 0.5,
          "A neighbourhood is planar if its standard deviation is below");
  v.field("max_normal_sigma_rad", max_normal_sigma_rad, 0.01, 1.0, "A normal must be known this well");
}

void PlaneSearchConfig::visit(ConfigVisitor& v) {
  v.field("distance_m", distance_m, 0.005, 0.5,
          "Points this close may belong to a plane; in a noisier cloud, four standard deviations");
  v.field("normal_angle_rad", normal_angle_rad, 0.05, 1.5,
          "Their normals differ from the plane's by less than this");
  v.field("hypotheses", hypotheses, 1, 10000, "Hypotheses drawn per plane");
  v.field("max_failures", max_failures, 1, 1000, "The search ends after so many rounds without a plane");
}

void PlaneSegmentConfig::visit(ConfigVisitor& v) {
  v.field("grid_m", grid_m, 0.02, 1.0, "Cell of the grid that outlines a segment");
  v.field("link_m", link_m, 0.05, 5.0,
          "Gaps up to this are bridged: shadows of furniture and gaps between rings, but no doorway");
  v.field("min_area_m2", min_area_m2, 0.01, 100.0, "Smaller segments are dropped");
  v.field("min_points", min_points, 10, 100000, "Segments of fewer raw points are dropped");
  v.field("min_filled", min_filled, 0.0, 1.0, "Share of a segment's grid cells that must hold points");
  v.field("max_rms_m", max_rms_m, 0.001, 0.5, "Segments that scatter more are dropped");
  v.field("max_planes", max_planes, 1, 64, "Planes per keyframe at most, the largest");
}

void PlaneNoiseConfig::visit(ConfigVisitor& v) {
  v.field("range_sigma_m", range_sigma_m, 0.0005, 0.5, "Noise of a range, for the weights of points");
  v.field("surface_sigma_m", surface_sigma_m, 0.0, 0.5, "Roughness of surfaces, for the same");
  v.field("scale", scale, 0.1, 1e4, "Factor on the covariance by the points' scatter: neighbours err alike");
  v.field("offset_floor_m", offset_floor_m, 0.0, 1.0,
          "Place of a keyframe in its own cloud, per horizontal direction of the body");
  v.field("height_floor_m", height_floor_m, 0.0, 1.0,
          "The same in height: few rings see floor or ceiling while the body bobs");
  v.field("tilt_floor_rad", tilt_floor_rad, 0.0, 1.0, "Attitude of a keyframe in its own cloud, per axis");
}

void PlanesConfig::visit(ConfigVisitor& v) {
  v.section("facets", facets, "Normals");
  v.section("search", search, "Sequential RANSAC");
  v.section("segments", segments, "Connected segments");
  v.section("noise", noise, "Covariance");
}

}  // namespace sgraphs
