#include "perception/odometry/knn_surfels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <nanoflann.hpp>

#include "perception/odometry/voxel_index.h"

namespace sgraphs {
namespace {

constexpr double kThin_m = 0.10;
constexpr double kSpacing_m = 0.40;  // between the centres of patches
constexpr int kNeighbours = 16;
constexpr double kReach_m = 1.0;

// The first return in each voxel of the given edge, in scan order.
std::vector<int32_t> thin(const LidarScan& scan, const std::vector<int32_t>& indices, double edge_m) {
  VoxelIndex index;
  std::vector<int32_t> kept;
  for (const int32_t i : indices) {
    const Eigen::Vector3d cell =
        (scan.points[static_cast<size_t>(i)].position_lidar.cast<double>() / edge_m).array().floor();
    const uint64_t key = VoxelIndex::pack(static_cast<int64_t>(cell.x()), static_cast<int64_t>(cell.y()),
                                          static_cast<int64_t>(cell.z()), 0);
    if (index.find(key) >= 0) continue;
    index.insert(key, i);
    kept.push_back(i);
  }
  return kept;
}

struct CloudView {
  const LidarScan& scan;
  const std::vector<int32_t>& indices;

  size_t kdtree_get_point_count() const { return indices.size(); }
  float kdtree_get_pt(size_t i, size_t axis) const {
    return scan.points[static_cast<size_t>(indices[i])].position_lidar[static_cast<Eigen::Index>(axis)];
  }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};

}  // namespace

std::vector<Surfel> knnSurfels(const LidarScan& scan, const std::vector<int32_t>& kept,
                               const SurfelConfig& config) {
  using Tree =
      nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, CloudView>, CloudView, 3>;
  const std::vector<int32_t> even = thin(scan, kept, kThin_m);
  std::vector<Surfel> surfels;
  if (even.size() < kNeighbours) return surfels;
  const CloudView view{scan, even};
  const Tree tree(3, view);
  for (const int32_t centre : thin(scan, even, kSpacing_m)) {
    const LidarPoint& point = scan.points[static_cast<size_t>(centre)];
    std::array<uint32_t, kNeighbours> found{};
    std::array<float, kNeighbours> distance2{};
    const size_t n = tree.knnSearch(point.position_lidar.data(), kNeighbours, found.data(), distance2.data());
    PatchMoments moments(point.position_lidar.cast<double>());
    for (size_t k = 0; k < n; ++k)
      if (distance2[k] < kReach_m * kReach_m)
        moments.add(scan.points[static_cast<size_t>(even[found[k]])].position_lidar.cast<double>());
    if (const std::optional<Surfel> surfel = moments.surfel(config, point.time_us))
      surfels.push_back(*surfel);
  }
  return surfels;
}

}  // namespace sgraphs
