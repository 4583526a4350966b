#include "tools/bench/baselines/point_map.h"

#include <algorithm>
#include <cmath>

namespace sgraphs::bench {
namespace {

constexpr int64_t kHalfCells = 1 << 20;  // cells each way: 50 km at 5 cm

}  // namespace

void PointMap::add(const Eigen::Vector3d& point_map) {
  const Eigen::Vector3d cell = (point_map / voxel_m_).array().floor();
  if (!(cell.cwiseAbs().maxCoeff() < static_cast<double>(kHalfCells))) return;  // a baseline that is lost
  int64_t key = 0;
  for (int axis = 2; axis >= 0; --axis)
    key = key * 2 * kHalfCells + static_cast<int64_t>(cell[axis]) + kHalfCells;
  const auto [found, is_new] = index_.try_emplace(key, voxels_.size());
  if (is_new) voxels_.push_back({key});
  Voxel& voxel = voxels_[found->second];
  voxel.sum += point_map;
  ++voxel.count;
}

std::vector<Eigen::Vector3f> PointMap::points() const {
  std::vector<Voxel> ordered = voxels_;
  std::sort(ordered.begin(), ordered.end(), [](const Voxel& a, const Voxel& b) { return a.key < b.key; });
  std::vector<Eigen::Vector3f> points;
  points.reserve(ordered.size());
  for (const Voxel& voxel : ordered)
    points.push_back((voxel.sum / static_cast<double>(voxel.count)).cast<float>());
  return points;
}

}  // namespace sgraphs::bench
