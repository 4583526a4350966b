#pragma once

#include "common/config/config_io.h"
#include "perception/odometry/clock_offset.h"

namespace sgraphs {

// Which returns of a scan are used at all.
struct PrefilterConfig {
  double min_range_m = 0.5;
  double max_range_m = 80.0;
  double body_min_x_m = -0.60, body_max_x_m = 0.60;
  double body_min_y_m = -0.35, body_max_y_m = 0.35;
  double body_min_z_m = -0.80, body_max_z_m = 0.30;
  int min_points = 500;

  void visit(ConfigVisitor& v);
};

// How a scan becomes surfels: small planar patches with mean, covariance and normal.
struct SurfelConfig {
  int column_stride = 10;
  double patch_radius_m = 0.12;
  int max_half_columns = 20;
  int min_points = 8;
  double max_thickness_m = 0.03;
  double max_normal_sigma_rad = 0.15;

  void visit(ConfigVisitor& v);
};

// The local map and the registration against it.
struct RegistrationConfig {
  double cell_m = 0.5;
  double map_radius_m = 60.0;
  double gate_m = 0.30;
  double max_normal_angle_rad = 0.7;
  double sigma_floor_m = 0.006;
  double cell_sigma_m = 0.003;
  double robust_width = 3.0;
  double robust_width_upright = 1.5;
  int max_iterations = 12;
  int segments = 1;
  double acceleration_sigma_mps2 = 0.8;
  double vertical_acceleration_sigma_mps2 = 5.0;
  double angular_acceleration_sigma_rps2 = 1.5;
  double height_sigma_m = 0.01;
  double height_memory_s = 2.0;
  double begin_sigma_m = 0.005;
  double begin_sigma_rad = 0.0008;
  double seam_sigma_m = 0.0001;
  double seam_vertical_sigma_m = 0.005;
  double seam_sigma_rad = 0.0001;
  double seam_weak_sigma_m = 0.015;
  double seam_weak_sigma_rad = 0.003;

  void visit(ConfigVisitor& v);
};

// The legs' odometry as a measurement (encoder and fused mode): per sample interval, plus shares of the
// motion.
struct LegsConfig {
  double sigma_m = 0.002;
  double sigma_per_m = 0.05;
  double sigma_rad = 0.001;
  double sigma_rad_per_rad = 0.05;
  double up_sigma_rad = 0.05;

  void visit(ConfigVisitor& v);
};

struct KeyframeConfig {
  double distance_m = 1.0;
  double angle_rad = 0.6;
  double min_inlier_share = 0.4;
  double voxel_m = 0.05;

  void visit(ConfigVisitor& v);
};

// Turns the information of registrations into calibrated covariances.
struct CovarianceConfig {
  double scale = 3.0;
  double floor_m = 0.001;
  double floor_rad = 0.0008;
  double neighbour_scale = 4.0;
  double neighbour_floor_m = 0.002;
  double neighbour_floor_rad = 0.0006;
  double neighbour_deflation = 1000.0;

  void visit(ConfigVisitor& v);
};

// When a standing robot is taken to ride in a lift, and where its map goes on.
struct LiftConfig {
  bool enabled = true;
  double car_reach_m = 3.0;
  double car_area_m2 = 9.0;
  double closed_s = 3.0;
  double storey_offset_m = 20.0;
  double vertical_sigma_rad = 0.005;

  void visit(ConfigVisitor& v);
};

// Members are listed once, in visit(); see config_io.h.
struct OdometryConfig {
  int threads = 2;
  PrefilterConfig prefilter;
  SurfelConfig surfels;
  RegistrationConfig registration;
  LegsConfig legs;
  ClockOffsetConfig clock;
  KeyframeConfig keyframes;
  CovarianceConfig covariance;
  LiftConfig lifts;

  void visit(ConfigVisitor& v);
};

}  // namespace sgraphs
