#include <algorithm>
#include <cmath>
#include <cstring>
#include <unordered_set>

#include "lcmtypes/convert/convert.h"

namespace sgraphs {
namespace {

constexpr double kVoxel_m = 0.1;
constexpr size_t kPointsPerChunk = kMaxChunkBytes / 6;

// The first point of each voxel.
std::vector<Eigen::Vector3f> thinned(const Keyframe& keyframe) {
  std::unordered_set<uint64_t> taken;  // only looked up
  std::vector<Eigen::Vector3f> points;
  for (const KeyframePoint& point : keyframe.points) {
    uint64_t voxel = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const double cell = std::floor(static_cast<double>(point.position_body[axis]) / kVoxel_m);
      voxel = voxel << 21 | (static_cast<uint64_t>(static_cast<int64_t>(cell)) & 0x1FFFFF);
    }
    if (taken.insert(voxel).second) points.push_back(point.position_body);
  }
  return points;
}

}  // namespace

std::vector<map_chunk_t> mapChunks(const Keyframe& keyframe) {
  const std::vector<Eigen::Vector3f> points = thinned(keyframe);
  float reach = 0;
  for (const Eigen::Vector3f& p : points) reach = std::max(reach, p.cwiseAbs().maxCoeff());
  map_chunk_t head{};
  head.header.utime = keyframe.time.us;
  head.keyframe = keyframe.id.value;
  head.resolution_m = std::max(kCloudResolution_m, static_cast<double>(reach) / kMaxCloudUnits);
  head.num_chunks =
      static_cast<int32_t>(std::max<size_t>(1, (points.size() + kPointsPerChunk - 1) / kPointsPerChunk));
  std::vector<map_chunk_t> chunks(static_cast<size_t>(head.num_chunks), head);
  for (size_t i = 0; i < points.size(); ++i)
    for (int axis = 0; axis < 3; ++axis)
      chunks[i / kPointsPerChunk].xyz.push_back(
          static_cast<int16_t>(std::lround(static_cast<double>(points[i][axis]) / head.resolution_m)));
  for (size_t i = 0; i < chunks.size(); ++i) {
    chunks[i].chunk = static_cast<int32_t>(i);
    chunks[i].num_coordinates = static_cast<int32_t>(chunks[i].xyz.size());
    chunks[i].num_points = chunks[i].num_coordinates / 3;
  }
  return chunks;
}

std::optional<std::vector<Eigen::Vector3f>> pointsOf(const map_chunk_t& m) {
  if (m.keyframe < 0 || m.chunk < 0 || m.chunk >= m.num_chunks || !(m.resolution_m > 0) ||
      !std::isfinite(m.resolution_m) || m.num_coordinates != 3 * m.num_points)
    return std::nullopt;
  std::vector<Eigen::Vector3f> points;
  for (size_t i = 0; i + 2 < m.xyz.size(); i += 3)
    points.push_back((m.resolution_m * Eigen::Vector3d(m.xyz[i], m.xyz[i + 1], m.xyz[i + 2])).cast<float>());
  return points;
}

}  // namespace sgraphs
