#pragma once

#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include "tools/bench/baselines/point_filter.h"

// For the .cpp files that call PCL; no other header includes it.
namespace sgraphs::bench {

using PclCloud = pcl::PointCloud<pcl::PointXYZ>;

inline PclCloud::Ptr toPcl(const Points& points) {
  auto cloud = PclCloud::Ptr(new PclCloud);
  cloud->reserve(points.size());
  for (const Eigen::Vector3f& p : points) cloud->push_back({p.x(), p.y(), p.z()});
  return cloud;
}

inline Eigen::Matrix4f toMatrix(const SE3& T) {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  matrix.topLeftCorner<3, 3>() = T.matrix3();
  matrix.topRightCorner<3, 1>() = T.translation;
  return matrix.cast<float>();
}

inline SE3 fromMatrix(const Eigen::Matrix4f& matrix) {
  const Eigen::Matrix3d rotation = matrix.topLeftCorner<3, 3>().cast<double>();
  return {Eigen::Quaterniond(rotation).normalized(), matrix.topRightCorner<3, 1>().cast<double>()};
}

}  // namespace sgraphs::bench
