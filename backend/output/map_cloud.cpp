#include "backend/output/map_cloud.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <unordered_map>

namespace sgraphs {
namespace {

struct VoxelKey {
  int64_t floor = 0;
  Eigen::Vector3i cell = Eigen::Vector3i::Zero();

  auto order() const { return std::make_tuple(floor, cell.z(), cell.y(), cell.x()); }
  bool operator==(const VoxelKey& other) const { return order() == other.order(); }
};

struct VoxelHash {
  size_t operator()(const VoxelKey& key) const {
    // Large odd multipliers spread neighbouring cells; the hash only finds voxels, it orders nothing.
    return static_cast<size_t>(key.cell.x()) * 0x9E3779B97F4A7C15ULL ^
           static_cast<size_t>(key.cell.y()) * 0xC2B2AE3D27D4EB4FULL ^
           static_cast<size_t>(key.cell.z()) * 0x165667B19E3779F9ULL ^ static_cast<size_t>(key.floor) << 56;
  }
};

struct Voxel {
  VoxelKey key;
  Eigen::Vector3d weighted_sum = Eigen::Vector3d::Zero();
  int64_t weight = 0;
};

}  // namespace

FloorId floorOf(const KeyframeNode& node) {
  return node.floor.valid() ? node.floor : FloorId{0};
}

std::vector<MapPoint> buildMap(const SituationalGraph& graph, double voxel_m) {
  std::vector<Voxel> voxels;
  std::unordered_map<VoxelKey, size_t, VoxelHash> index;
  for (const auto& [id, node] : graph.keyframes) {
    if (!node.keyframe) continue;
    const Eigen::Matrix3d rotation = node.T_map_body.matrix3();
    for (const KeyframePoint& point : node.keyframe->points) {
      const Eigen::Vector3d p = rotation * point.position_body.cast<double>() + node.T_map_body.translation;
      if (!p.allFinite() || p.cwiseAbs().maxCoeff() > 1e6) continue;
      const VoxelKey key{floorOf(node).value, (p / voxel_m).array().floor().cast<int>()};
      const auto [found, is_new] = index.try_emplace(key, voxels.size());
      if (is_new) voxels.push_back({key});
      Voxel& voxel = voxels[found->second];
      const int weight = std::max<int>(1, point.count);
      voxel.weighted_sum += weight * p;
      voxel.weight += weight;
    }
  }
  std::sort(voxels.begin(), voxels.end(),
            [](const Voxel& a, const Voxel& b) { return a.key.order() < b.key.order(); });
  std::vector<MapPoint> map;
  map.reserve(voxels.size());
  for (const Voxel& voxel : voxels)
    map.push_back({(voxel.weighted_sum / static_cast<double>(voxel.weight)).cast<float>(),
                   FloorId{voxel.key.floor}, voxel.weight});
  return map;
}

}  // namespace sgraphs
