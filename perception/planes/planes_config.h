#pragma once

#include "common/config/config_io.h"
#include "common/geometry/se3.h"

namespace sgraphs {

// How a keyframe's cloud becomes facets: small patches with a normal, the units of the search for planes.
struct FacetConfig {
  double cell_m = 0.10;
  double cell_range_m = 3.5;
  int min_points = 8;
  double max_thickness_m = 0.04;
  double max_normal_sigma_rad = 0.2;

  void visit(ConfigVisitor& v);
};

// Sequential RANSAC.
struct PlaneSearchConfig {
  double distance_m = 0.05;
  double normal_angle_rad = 0.45;
  int hypotheses = 12;
  int max_failures = 4;

  void visit(ConfigVisitor& v);
};

// What is one segment, and which segments are planes.
struct PlaneSegmentConfig {
  double grid_m = 0.10;
  double link_m = 0.60;
  double min_area_m2 = 0.30;
  int min_points = 100;
  double min_filled = 0.15;
  double max_rms_m = 0.035;
  int max_planes = 64;

  void visit(ConfigVisitor& v);
};

// Turns the scatter of points into a calibrated covariance.
struct PlaneNoiseConfig {
  double range_sigma_m = 0.015;
  double surface_sigma_m = 0.005;
  double scale = 2.5;
  double offset_floor_m = 0.0015;
  double height_floor_m = 0.006;
  double tilt_floor_rad = 0.0014;

  // The floors as one: of the keyframe's own pose in its cloud, translation [m] then rotation [rad] in body.
  Vector6d poseSigma() const {
    Vector6d sigma;
    sigma << offset_floor_m, offset_floor_m, height_floor_m, Eigen::Vector3d::Constant(tilt_floor_rad);
    return sigma;
  }

  void visit(ConfigVisitor& v);
};

// Members are listed once, in visit(); see config_io.h.
struct PlanesConfig {
  FacetConfig facets;
  PlaneSearchConfig search;
  PlaneSegmentConfig segments;
  PlaneNoiseConfig noise;

  void visit(ConfigVisitor& v);
};

}  // namespace sgraphs
