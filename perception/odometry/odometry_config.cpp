#include "perception/odometry/odometry_config.h"

namespace sgraphs {

void PrefilterConfig::visit(ConfigVisitor& v) {
  v.field("min_range_m", min_range_m, 0.0, 10.0, "Returns nearer than this are dropped");
  v.field("max_range_m", max_range_m, 1.0, 300.0, "Returns farther than this are dropped");
  v.field("body_min_x_m", body_min_x_m, -5.0, 0.0,
          "Box around the robot in body: returns inside are its own");
  v.field("body_max_x_m", body_max_x_m, 0.0, 5.0, "Box around the robot in body");
  v.field("body_min_y_m", body_min_y_m, -5.0, 0.0, "Box around the robot in body");
  v.field("body_max_y_m", body_max_y_m, 0.0, 5.0, "Box around the robot in body");
  v.field("body_min_z_m", body_min_z_m, -5.0, 0.0, "Box around the robot in body");
  v.field("body_max_z_m", body_max_z_m, 0.0, 5.0, "Box around the robot in body");
  v.field("min_points", min_points, 1, 100000, "A scan with fewer usable returns is refused and counted");
}

void SurfelConfig::visit(ConfigVisitor& v) {
  v.field("column_stride", column_stride, 1, 100,
          "Firing sequences between the centres of patches on a ring");
  v.field("patch_radius_m", patch_radius_m, 0.02, 1.0, "Half width of a patch along its ring");
  v.field("max_half_columns", max_half_columns, 1, 50, "Half width of a patch at most, in firing sequences");
  v.field("min_points", min_points, 5, 100, "A patch of fewer returns is dropped");
  v.field("max_thickness_m", max_thickness_m, 0.005, 0.5,
          "A patch is planar if its standard deviation is below");
  v.field("max_normal_sigma_rad", max_normal_sigma_rad, 0.01, 1.0, "A patch must know its normal this well");
}

void RegistrationConfig::visit(ConfigVisitor& v) {
  v.field("cell_m", cell_m, 0.1, 5.0, "Edge of the local map's cells");
  v.field("map_radius_m", map_radius_m, 5.0, 1000.0, "Cells farther from the robot are forgotten");
  v.field("gate_m", gate_m, 0.05, 2.0, "Largest distance between a patch and the surface it is matched to");
  v.field("max_normal_angle_rad", max_normal_angle_rad, 0.05, 1.5,
          "Largest angle between the normals of a match");
  v.field("sigma_floor_m", sigma_floor_m, 0.0005, 0.1,
          "Error of the surface model that averaging does not reduce");
  v.field("cell_sigma_m", cell_sigma_m, 0.0, 0.1,
          "Error of a cell's plane, which all patches that are matched to it have in common");
  v.field("robust_width", robust_width, 0.5, 20.0,
          "Width of the Cauchy kernel in standard deviations; on upright surfaces only at first");
  v.field("robust_width_upright", robust_width_upright, 0.5, 20.0,
          "The width it ends with on upright surfaces, some of which are people that walk");
  v.field("max_iterations", max_iterations, 1, 100, "Gauss-Newton iterations per scan at most");
  v.field("segments", segments, 1, 8, "Pieces of constant twist that a scan's motion is made of");
  v.field("acceleration_sigma_mps2", acceleration_sigma_mps2, 0.1, 100.0,
          "Prior on the change of horizontal velocity");
  v.field("vertical_acceleration_sigma_mps2", vertical_acceleration_sigma_mps2, 0.1, 100.0,
          "Prior on the change of vertical velocity: a walking body bobs");
  v.field("angular_acceleration_sigma_rps2", angular_acceleration_sigma_rps2, 0.1, 100.0,
          "Prior on the change of angular velocity");
  v.field("height_sigma_m", height_sigma_m, 1e-4, 100.0,
          "Lidar mode: how well a walking body keeps its height where no floor or ceiling is in view");
  v.field("height_memory_s", height_memory_s, 0.1, 100.0, "Time over which that height follows the body");
  v.field("begin_sigma_m", begin_sigma_m, 1e-5, 1.0,
          "A scan begins where the one before ended, within this as long as the map is young");
  v.field("begin_sigma_rad", begin_sigma_rad, 1e-6, 1.0, "The same, of the rotation");
  v.field("seam_sigma_m", seam_sigma_m, 1e-6, 1.0,
          "Later: as well as the end is known and this, of the horizontal motion that a constant twist "
          "leaves out");
  v.field("seam_vertical_sigma_m", seam_vertical_sigma_m, 1e-6, 1.0,
          "The same along the vertical: a walking body bobs");
  v.field("seam_sigma_rad", seam_sigma_rad, 1e-6, 1.0, "The same, of the rotation");
  v.field("seam_weak_sigma_m", seam_weak_sigma_m, 1e-5, 1.0,
          "Lidar mode: within this in directions in which the end is hardly known");
  v.field("seam_weak_sigma_rad", seam_weak_sigma_rad, 1e-5, 1.0, "The same, of the rotation");
}

void LegsConfig::visit(ConfigVisitor& v) {
  v.field("sigma_m", sigma_m, 1e-4, 1.0, "Noise of a step's translation");
  v.field("sigma_per_m", sigma_per_m, 0.0, 1.0, "Share of the distance added to it");
  v.field("sigma_rad", sigma_rad, 1e-5, 1.0, "Noise of a step's rotation");
  v.field("sigma_rad_per_rad", sigma_rad_per_rad, 0.0, 1.0, "Share of the rotation added to it");
  v.field("up_sigma_rad", up_sigma_rad, 1e-4, 0.5,
          "Error of the up direction per keyframe: 5 mrad times the root of the 100 keyframes over which an "
          "inertial unit errs alike");
}

void KeyframeConfig::visit(ConfigVisitor& v) {
  v.field("distance_m", distance_m, 0.1, 20.0, "A keyframe after this distance");
  v.field("angle_rad", angle_rad, 0.05, 3.2, "A keyframe after this rotation");
  v.field("min_inlier_share", min_inlier_share, 0.0, 1.0, "A keyframe when fewer patches find the local map");
  v.field("voxel_m", voxel_m, 0.01, 1.0,
          "Keyframe clouds are thinned to one centroid per voxel of this edge");
}

void CovarianceConfig::visit(ConfigVisitor& v) {
  v.field("scale", scale, 0.1, 1e4,
          "Factor on the covariance of a scan's registration: neighbouring patches err alike");
  v.field("floor_m", floor_m, 0.0, 1.0, "Added between keyframes, in quadrature");
  v.field("floor_rad", floor_rad, 0.0, 1.0, "Added between keyframes, in quadrature");
  v.field("neighbour_scale", neighbour_scale, 0.1, 1e4,
          "Factor on the covariance of keyframe-to-keyframe registration");
  v.field("neighbour_floor_m", neighbour_floor_m, 0.0, 1.0,
          "Added to it in quadrature: the clouds' own distortion");
  v.field("neighbour_floor_rad", neighbour_floor_rad, 0.0, 1.0, "Added to it in quadrature");
  v.field("neighbour_deflation", neighbour_deflation, 1.0, 1e6,
          "Factor on it where the odometry is a registration of the same points (lidar, fused)");
}

void LiftConfig::visit(ConfigVisitor& v) {
  v.field("enabled", enabled, "Whether rides in lifts are looked for");
  v.field("car_reach_m", car_reach_m, 0.5, 20.0, "A closed space that is seen no farther than this is a car");
  v.field("car_area_m2", car_area_m2, 0.5, 100.0, "Area of a car, seen from above, at most");
  v.field("closed_s", closed_s, 1.0, 60.0, "A ride keeps the door closed for this long at least");
  v.field("storey_offset_m", storey_offset_m, 10.0, 1000.0,
          "Height of a ride, which nothing measures: what is mapped after it lies clear of what is known");
  v.field("vertical_sigma_rad", vertical_sigma_rad, 1e-4, 0.1, "How well the direction of a ride is known");
}

void OdometryConfig::visit(ConfigVisitor& v) {
  v.field("threads", threads, 1, 64, "Worker threads; the result does not depend on it");
  v.section("prefilter", prefilter, "Which returns are used");
  v.section("surfels", surfels, "Planar patches of a scan");
  v.section("registration", registration, "Local map and registration");
  v.section("legs", legs, "Odometry of the legs as a measurement");
  v.section("clock", clock, "Clock of the legs against the LiDAR's");
  v.section("keyframes", keyframes, "When a scan becomes a keyframe");
  v.section("covariance", covariance, "Calibration of covariances");
  v.section("lifts", lifts, "Rides in lifts");
}

}  // namespace sgraphs
