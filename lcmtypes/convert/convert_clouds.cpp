#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "lcmtypes/convert/convert.h"

// Conversions of the chunked messages.
namespace sgraphs {
namespace {

static_assert(std::endian::native == std::endian::little, "cloud bytes are little-endian");

constexpr size_t kPointBytes = 8;

// Splits n items into chunks of at most `most`; at least one chunk.
std::vector<std::pair<size_t, size_t>> chunksOf(size_t n, size_t most) {
  std::vector<std::pair<size_t, size_t>> ranges;
  for (size_t begin = 0; begin == 0 || begin < n; begin += most)
    ranges.emplace_back(begin, std::min(n, begin + most));
  return ranges;
}

int16_t quantise(float value, double resolution_m) {
  return static_cast<int16_t>(std::clamp(std::round(value / resolution_m), -kMaxCloudUnits, kMaxCloudUnits));
}

}  // namespace

relative_pose_t toMessage(const RelativePose& r) {
  relative_pose_t m{};
  m.kind = static_cast<int32_t>(r.kind);
  m.from_keyframe = r.from.value;
  m.to_keyframe = r.to.value;
  m.T_from_to = toMessage(r.T_from_to);
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) m.covariance[6 * i + j] = r.covariance(i, j);
  m.registered = r.registered;
  return m;
}

std::optional<RelativePose> fromMessage(const relative_pose_t& m) {
  const std::optional<SE3> T = fromMessage(m.T_from_to);
  const Matrix6d covariance = Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(m.covariance);
  if (!T || m.kind < 0 || m.kind > 2 || m.from_keyframe < 0 || m.to_keyframe < 0 || !covariance.allFinite() ||
      covariance.llt().info() != Eigen::Success)
    return std::nullopt;
  return RelativePose{static_cast<RelativePoseKind>(m.kind),
                      KeyframeId{m.from_keyframe},
                      KeyframeId{m.to_keyframe},
                      *T,
                      covariance,
                      m.registered != 0};
}

std::vector<lidar_points_t> toMessages(const LidarScan& scan) {
  constexpr size_t kMost = kMaxChunkBytes / 17;  // 12 bytes of position, 4 of time, 1 of ring
  const auto ranges = chunksOf(scan.points.size(), kMost);
  std::vector<lidar_points_t> chunks;
  for (const auto& [begin, end] : ranges) {
    lidar_points_t m{};
    m.header.utime = scan.end.us;
    m.sweep = scan.sequence;
    m.chunk = static_cast<int32_t>(chunks.size());
    m.num_chunks = static_cast<int32_t>(ranges.size());
    m.has_time = !scan.deskewed;
    m.has_ring = scan.num_rings > 0;
    m.num_points = static_cast<int32_t>(end - begin);
    m.num_xyz_bytes = 12 * m.num_points;
    m.xyz.resize(12 * (end - begin));
    for (size_t i = begin; i < end; ++i) {
      const LidarPoint& p = scan.points[i];
      std::memcpy(&m.xyz[12 * (i - begin)], p.position_lidar.data(), 12);
      if (m.has_time) m.time_us.push_back(p.time_us);
      if (m.has_ring) m.ring.push_back(p.ring);
    }
    m.num_times = static_cast<int32_t>(m.time_us.size());
    m.num_rings = static_cast<int32_t>(m.ring.size());
    chunks.push_back(std::move(m));
  }
  return chunks;
}

std::optional<LidarScan> fromMessages(std::span<const lidar_points_t> chunks) {
  if (chunks.empty() || chunks.front().num_chunks != static_cast<int32_t>(chunks.size())) return std::nullopt;
  LidarScan scan;
  scan.end = Time{chunks.front().header.utime};
  scan.begin = scan.end;
  scan.sequence = chunks.front().sweep;
  scan.deskewed = chunks.front().has_time == 0;
  for (size_t c = 0; c < chunks.size(); ++c) {
    const lidar_points_t& m = chunks[c];
    if (m.chunk != static_cast<int32_t>(c) || m.sweep != scan.sequence ||
        m.num_xyz_bytes != 12 * m.num_points || m.has_time != chunks.front().has_time ||
        m.has_ring != chunks.front().has_ring || m.num_times != (m.has_time ? m.num_points : 0) ||
        m.num_rings != (m.has_ring ? m.num_points : 0))
      return std::nullopt;
    for (int i = 0; i < m.num_points; ++i) {
      const auto k = static_cast<size_t>(i);
      LidarPoint p;
      std::memcpy(p.position_lidar.data(), &m.xyz[12 * k], 12);
      if (!p.position_lidar.allFinite()) continue;  // "no return" in many drivers' clouds
      if (m.has_time) {
        if (m.time_us[k] > 0) return std::nullopt;
        p.time_us = m.time_us[k];
        scan.begin = std::min(scan.begin, scan.end + Duration{p.time_us});
      }
      if (m.has_ring) {
        p.ring = m.ring[k];
        scan.num_rings = std::max<uint16_t>(scan.num_rings, static_cast<uint16_t>(p.ring + 1));
      }
      scan.points.push_back(p);
    }
  }
  return scan;
}

std::vector<keyframe_t> toMessages(const Keyframe& keyframe) {
  float reach = 0;
  for (const KeyframePoint& p : keyframe.points)
    reach = std::max(reach, p.position_body.cwiseAbs().maxCoeff());
  keyframe_t head{};
  head.header.utime = keyframe.time.us;
  head.keyframe = keyframe.id.value;
  head.scan = keyframe.scan;
  head.T_odom_body = toMessage(keyframe.T_odom_body);
  for (const RelativePose& r : keyframe.relative_poses) head.relative_poses.push_back(toMessage(r));
  head.num_relative_poses = static_cast<int32_t>(head.relative_poses.size());
  for (int i = 0; i < 3; ++i) head.up_body[i] = keyframe.up_body[i];
  head.up_sigma_rad = keyframe.up_sigma_rad;
  for (const SE3& T : keyframe.T_keyframe_body) head.T_keyframe_body.push_back(toMessage(T));
  head.num_scans = static_cast<int32_t>(head.T_keyframe_body.size());
  head.T_body_lidar = toMessage(keyframe.T_body_lidar);
  head.resolution_m = std::max(kCloudResolution_m, reach / kMaxCloudUnits);

  const auto ranges = chunksOf(keyframe.points.size(), kMaxChunkBytes / kPointBytes);
  head.num_chunks = static_cast<int32_t>(ranges.size());
  std::vector<keyframe_t> chunks;
  for (const auto& [begin, end] : ranges) {
    keyframe_t m = head;
    m.chunk = static_cast<int32_t>(chunks.size());
    m.num_points = static_cast<int32_t>(end - begin);
    m.num_bytes = static_cast<int32_t>(kPointBytes) * m.num_points;
    m.points.resize(kPointBytes * (end - begin));
    for (size_t i = begin; i < end; ++i) {
      const KeyframePoint& p = keyframe.points[i];
      uint8_t* out = &m.points[kPointBytes * (i - begin)];
      for (int a = 0; a < 3; ++a) {
        const int16_t units = quantise(p.position_body[a], m.resolution_m);
        std::memcpy(out + 2 * a, &units, 2);
      }
      out[6] = p.scan;
      out[7] = p.count;
    }
    chunks.push_back(std::move(m));
  }
  return chunks;
}

std::optional<Keyframe> fromMessages(std::span<const keyframe_t> chunks) {
  if (chunks.empty()) return std::nullopt;
  const keyframe_t& head = chunks.front();
  Keyframe keyframe;
  const std::optional<SE3> T_odom_body = fromMessage(head.T_odom_body),
                           T_body_lidar = fromMessage(head.T_body_lidar);
  keyframe.up_body = Eigen::Vector3d(head.up_body[0], head.up_body[1], head.up_body[2]);
  if (!T_odom_body || !T_body_lidar || head.keyframe < 0 || !(head.resolution_m > 0) ||
      !std::isfinite(head.resolution_m) || !keyframe.up_body.allFinite() || !std::isfinite(head.up_sigma_rad))
    return std::nullopt;
  keyframe.id = KeyframeId{head.keyframe};
  keyframe.time = Time{head.header.utime};
  keyframe.scan = head.scan;
  keyframe.T_odom_body = *T_odom_body;
  keyframe.up_sigma_rad = head.up_sigma_rad;
  keyframe.T_body_lidar = *T_body_lidar;
  for (const relative_pose_t& m : head.relative_poses) {
    const std::optional<RelativePose> r = fromMessage(m);
    if (!r) return std::nullopt;
    keyframe.relative_poses.push_back(*r);
  }
  for (const transform_t& m : head.T_keyframe_body) {
    const std::optional<SE3> T = fromMessage(m);
    if (!T) return std::nullopt;
    keyframe.T_keyframe_body.push_back(*T);
  }
  for (const keyframe_t& m : chunks) {
    if (m.keyframe != head.keyframe || m.num_bytes != static_cast<int32_t>(kPointBytes) * m.num_points)
      return std::nullopt;
    for (int i = 0; i < m.num_points; ++i) {
      const uint8_t* in = &m.points[kPointBytes * static_cast<size_t>(i)];
      KeyframePoint p;
      for (int a = 0; a < 3; ++a) {
        int16_t units = 0;
        std::memcpy(&units, in + 2 * a, 2);
        p.position_body[a] = static_cast<float>(units * head.resolution_m);
      }
      p.scan = in[6];
      p.count = in[7];
      if (p.scan >= keyframe.T_keyframe_body.size() || p.count == 0) return std::nullopt;
      keyframe.points.push_back(p);
    }
  }
  return keyframe;
}

}  // namespace sgraphs
