#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "common/geometry/se3.h"
#include "common/types/lidar_scan.h"
#include "perception/odometry/odometry_config.h"

namespace sgraphs {

// A planar patch of one scan, in body at the firing of its centre.
struct Surfel {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();      // unit, towards the sensor
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  // of the points about the mean [m^2]
  double count = 0;                                      // points behind it
  double variance_m2 = 0;                                // of the mean along the normal
  int32_t time_us = 0;                                   // relative to the scan's end

  void visitState(auto& archive) { archive(mean, normal, covariance, count, variance_m2, time_us); }
};

// Variance [rad^2] of the normal of `count` points that scatter thickness2 [m^2] along it and width2 along
// the narrower direction across it: of an eigenvector (Anderson, "Asymptotic theory for principal component
// analysis", 1963). A patch as thick as it is wide has no normal.
double normalVariance(double thickness2, double width2, double count);

// Indices into scan.points of the returns that pass the range gate, the robot's own box, and have a neighbour
// on a surface: an isolated return in the air is none. Points that are not finite are dropped.
std::vector<int32_t> prefilter(const LidarScan& scan, const SE3& T_body_lidar, const PrefilterConfig& config);

// Patches of the scan, from its rings and columns where it has them, else from nearest neighbours. A patch
// spans about 1 ms, so its shape needs no deskewing; only its place depends on the motion.
std::vector<Surfel> extractSurfels(const LidarScan& scan, const std::vector<int32_t>& kept,
                                   const SE3& T_body_lidar, const SurfelConfig& config, int threads);

}  // namespace sgraphs
