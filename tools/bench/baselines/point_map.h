#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <vector>

namespace sgraphs::bench {

// Centroids of the points in each voxel.
class PointMap {
 public:
  explicit PointMap(double voxel_m) : voxel_m_(voxel_m) {}

  void add(const Eigen::Vector3d& point_map);
  // Ordered by voxel.
  std::vector<Eigen::Vector3f> points() const;

 private:
  struct Voxel {
    int64_t key = 0;
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    int64_t count = 0;
  };

  double voxel_m_;
  std::vector<Voxel> voxels_;
  std::unordered_map<int64_t, size_t> index_;  // finds voxels, orders nothing
};

}  // namespace sgraphs::bench
