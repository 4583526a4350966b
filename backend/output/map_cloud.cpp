#include "backend/output/map_cloud.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <vector>

namespace sgraphs {
namespace {

struct VoxelKey {
  int64_t floor = 0;
  Eigen::Vector3i cell = Eigen::Vector3i::Zero();

  auto order() const { return std::make_tuple(floor, cell.z(), cell.y(), cell.x()); }
  bool operator==(const VoxelKey& other) const { return order() == other.order(); }
};

struct Voxel {
  VoxelKey key;
  Eigen::Vector3d weighted_sum = Eigen::Vector3d::Zero();
  int64_t weight = 0;
};

// Voxels in order of their first point, found by open addressing: half of a map's time went into the nodes of
// std::unordered_map.
class VoxelTable {
 public:
  VoxelTable() : slots_(1 << 16, -1) {}

  Voxel& at(const VoxelKey& key) {
    if (2 * (voxels_.size() + 1) > slots_.size()) grow();
    int32_t& slot = slots_[slotOf(key)];
    if (slot < 0) {
      slot = static_cast<int32_t>(voxels_.size());
      voxels_.push_back({key});
    }
    return voxels_[static_cast<size_t>(slot)];
  }
  std::vector<Voxel>& voxels() { return voxels_; }

 private:
  // The slot of the key, or the empty one where it belongs.
  size_t slotOf(const VoxelKey& key) const {
    // Large odd multipliers spread neighbouring cells; the hash only finds voxels, it orders nothing.
    const uint64_t hash = static_cast<uint64_t>(key.cell.x()) * 0x9E3779B97F4A7C15ULL ^
                          static_cast<uint64_t>(key.cell.y()) * 0xC2B2AE3D27D4EB4FULL ^
                          static_cast<uint64_t>(key.cell.z()) * 0x165667B19E3779F9ULL ^
                          static_cast<uint64_t>(key.floor) << 56;
    for (size_t i = hash ^ (hash >> 32);; ++i) {
      const int32_t slot = slots_[i & (slots_.size() - 1)];
      if (slot < 0 || voxels_[static_cast<size_t>(slot)].key == key) return i & (slots_.size() - 1);
    }
  }
  void grow() {
    slots_.assign(2 * slots_.size(), -1);
    for (size_t i = 0; i < voxels_.size(); ++i) slots_[slotOf(voxels_[i].key)] = static_cast<int32_t>(i);
  }

  std::vector<Voxel> voxels_;
  std::vector<int32_t> slots_;  // a power of two of them; -1: empty
};

}  // namespace

FloorId floorOf(const KeyframeNode& node) {
  return node.floor.valid() ? node.floor : FloorId{0};
}

std::vector<MapPoint> buildMap(const SituationalGraph& graph, double voxel_m) {
  VoxelTable table;
  for (const auto& [id, node] : graph.keyframes) {
    if (!node.keyframe) continue;
    const Eigen::Matrix3d rotation = node.T_map_body.matrix3();
    for (const KeyframePoint& point : node.keyframe->points) {
      const Eigen::Vector3d p = rotation * point.position_body.cast<double>() + node.T_map_body.translation;
      if (!p.allFinite() || p.cwiseAbs().maxCoeff() > 1e6) continue;
      const VoxelKey key{floorOf(node).value, (p / voxel_m).array().floor().cast<int>()};
      Voxel& voxel = table.at(key);
      const int weight = std::max<int>(1, point.count);
      voxel.weighted_sum += weight * p;
      voxel.weight += weight;
    }
  }
  std::vector<Voxel>& voxels = table.voxels();
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
