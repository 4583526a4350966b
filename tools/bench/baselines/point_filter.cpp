#include "tools/bench/baselines/point_filter.h"

#include <pcl/filters/radius_outlier_removal.h>
#include <pcl/filters/voxel_grid.h>

#include "tools/bench/baselines/pcl_points.h"

namespace sgraphs::bench {

Points pointsInBody(const LidarScan& scan, const SE3& T_body_lidar, const PointFilterConfig& config) {
  const Eigen::Matrix3f rotation = T_body_lidar.matrix3().cast<float>();
  const Eigen::Vector3f translation = T_body_lidar.translation.cast<float>();
  Points points;
  points.reserve(scan.points.size());
  for (const LidarPoint& point : scan.points) {
    const float range_m = point.position_lidar.norm();
    if (range_m < config.min_range_m || range_m > config.max_range_m) continue;
    points.push_back(rotation * point.position_lidar + translation);
  }
  return points;
}

Points prefilter(const LidarScan& scan, const SE3& T_body_lidar, const PointFilterConfig& config) {
  const PclCloud::Ptr all = toPcl(pointsInBody(scan, T_body_lidar, config));
  const PclCloud::Ptr thinned(new PclCloud);
  pcl::VoxelGrid<pcl::PointXYZ> grid;
  const auto leaf = static_cast<float>(config.voxel_m);
  grid.setLeafSize(leaf, leaf, leaf);
  grid.setInputCloud(all);
  grid.filter(*thinned);
  PclCloud clean;
  pcl::RadiusOutlierRemoval<pcl::PointXYZ> outliers;
  outliers.setRadiusSearch(config.outlier_radius_m);
  outliers.setMinNeighborsInRadius(config.outlier_neighbours);
  outliers.setInputCloud(thinned);
  outliers.filter(clean);
  Points points;
  points.reserve(clean.size());
  for (const pcl::PointXYZ& p : clean) points.push_back(p.getVector3fMap());
  return points;
}

}  // namespace sgraphs::bench
