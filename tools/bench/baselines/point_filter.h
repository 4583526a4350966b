#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/geometry/se3.h"
#include "common/types/lidar_scan.h"

namespace sgraphs::bench {

using Points = std::vector<Eigen::Vector3f>;

// HDL-SLAM's prefilter: range gate, voxel grid, removal of points with few neighbours.
struct PointFilterConfig {
  double min_range_m = 0.5;
  double max_range_m = 100.0;
  double voxel_m = 0.1;
  double outlier_radius_m = 0.5;
  int outlier_neighbours = 2;
};

// Returns within the range gate, in body. No deskewing: HDL-SLAM turns points back by an IMU only, and there
// is none in our recordings.
Points pointsInBody(const LidarScan& scan, const SE3& T_body_lidar, const PointFilterConfig& config);

// The same, thinned and cleaned by PCL.
Points prefilter(const LidarScan& scan, const SE3& T_body_lidar, const PointFilterConfig& config);

}  // namespace sgraphs::bench
