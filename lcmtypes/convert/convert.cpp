#include "lcmtypes/convert/convert.h"

#include <algorithm>
#include <cmath>

namespace sgraphs {
namespace {

template <int N>
void copyOut(const Eigen::Matrix<double, N, N>& m, double* out) {
  for (int r = 0; r < N; ++r)
    for (int c = 0; c < N; ++c) out[r * N + c] = m(r, c);
}

// A covariance must be finite, with a positive diagonal and symmetric to rounding.
std::optional<Matrix6d> covarianceFrom(const double* values) {
  const Matrix6d m = Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(values);
  if (!m.allFinite() || (m.diagonal().array() <= 0).any() || !m.isApprox(m.transpose(), 1e-6))
    return std::nullopt;
  return m;
}

}  // namespace

transform_t toMessage(const SE3& T) {
  transform_t m{};
  for (int i = 0; i < 3; ++i) m.xyz[i] = T.translation[i];
  m.wxyz[0] = T.rotation.w();
  m.wxyz[1] = T.rotation.x();
  m.wxyz[2] = T.rotation.y();
  m.wxyz[3] = T.rotation.z();
  return m;
}

std::optional<SE3> fromMessage(const transform_t& m) {
  const SE3 T(Eigen::Quaterniond(m.wxyz[0], m.wxyz[1], m.wxyz[2], m.wxyz[3]), {m.xyz[0], m.xyz[1], m.xyz[2]});
  if (!T.isFinite() || std::abs(T.rotation.norm() - 1.0) > 1e-6) return std::nullopt;
  return T;
}

session_t toMessage(const Session& session, Time now) {
  session_t m{};
  m.header.session = session.id;
  m.header.utime = now.us;
  m.schema = kMessageSchema;
  m.writer = session.writer;
  m.num_stages = static_cast<int32_t>(session.stages.size());
  m.stages = session.stages;
  m.odometry_mode = session.odometry_mode;
  m.has_odometry = session.has_odometry;
  m.T_body_lidar = toMessage(session.T_body_lidar);
  m.config_digest = session.config_digest;
  return m;
}

std::optional<Session> fromMessage(const session_t& m) {
  const std::optional<SE3> T_body_lidar = fromMessage(m.T_body_lidar);
  if (m.header.session == 0 || m.schema != kMessageSchema || !T_body_lidar) return std::nullopt;
  Session session;
  session.id = m.header.session;
  session.start = Time{m.header.utime};
  session.writer = m.writer;
  session.stages = m.stages;
  session.odometry_mode = m.odometry_mode;
  session.has_odometry = m.has_odometry != 0;
  session.T_body_lidar = *T_body_lidar;
  session.config_digest = m.config_digest;
  return session;
}

spot_odometry_t toMessage(const BodyOdometry& odometry) {
  spot_odometry_t m{};
  m.header.utime = odometry.time.us;
  m.T_odom_body = toMessage(odometry.T_odom_body);
  return m;
}

std::optional<BodyOdometry> fromMessage(const spot_odometry_t& m) {
  const std::optional<SE3> T = fromMessage(m.T_odom_body);
  if (!T) return std::nullopt;
  return BodyOdometry{Time{m.header.utime}, *T};
}

odometry_t toMessage(const OdometryEstimate& e) {
  odometry_t m{};
  m.header.utime = e.time.us;
  m.scan = e.scan;
  m.T_odom_body = toMessage(e.T_odom_body);
  for (int i = 0; i < 6; ++i) m.twist_body[i] = e.twist_body[i];
  copyOut<6>(e.covariance, m.covariance);
  m.inlier_share = e.inlier_share;
  m.residual_rms_m = e.residual_rms_m;
  m.num_degenerate = static_cast<int8_t>(e.num_degenerate);
  m.extrapolated = e.extrapolated;
  m.keyframe = e.keyframe.value;
  m.is_keyframe = e.is_keyframe;
  return m;
}

std::optional<OdometryEstimate> fromMessage(const odometry_t& m) {
  const std::optional<SE3> T = fromMessage(m.T_odom_body);
  const std::optional<Matrix6d> covariance = covarianceFrom(m.covariance);
  OdometryEstimate e;
  for (int i = 0; i < 6; ++i) e.twist_body[i] = m.twist_body[i];
  if (!T || !covariance || !e.twist_body.allFinite() || m.scan < 0 || m.num_degenerate < 0)
    return std::nullopt;
  e.time = Time{m.header.utime};
  e.scan = m.scan;
  e.T_odom_body = *T;
  e.covariance = *covariance;
  e.inlier_share = m.inlier_share;
  e.residual_rms_m = m.residual_rms_m;
  e.num_degenerate = static_cast<uint8_t>(m.num_degenerate);
  e.extrapolated = m.extrapolated != 0;
  e.keyframe = KeyframeId{m.keyframe};
  e.is_keyframe = m.is_keyframe != 0;
  return e;
}

pose_t toPoseMessage(Time time, const SE3& T, const Vector6d& twist_body) {
  pose_t m{};
  m.utime = time.us;
  for (int i = 0; i < 3; ++i) {
    m.pos[i] = T.translation[i];
    m.vel[i] = twist_body[i];
    m.rotation_rate[i] = twist_body[3 + i];
  }
  m.orientation[0] = T.rotation.w();
  m.orientation[1] = T.rotation.x();
  m.orientation[2] = T.rotation.y();
  m.orientation[3] = T.rotation.z();
  return m;
}

velodyne_packets_t toMessage(std::span<const VelodynePacket> packets, int64_t revolution, int32_t part,
                             bool last_part) {
  velodyne_packets_t m{};
  m.header.utime = packets.empty() ? 0 : packets.front().time.us;
  m.revolution = revolution;
  m.part = part;
  m.last_part = last_part;
  m.num_packets = static_cast<int32_t>(packets.size());
  for (const VelodynePacket& packet : packets) {
    m.packet_utime.push_back(packet.time.us);
    m.data.insert(m.data.end(), packet.bytes.begin(), packet.bytes.end());
  }
  m.num_bytes = static_cast<int32_t>(m.data.size());
  return m;
}

std::optional<std::vector<VelodynePacket>> fromMessage(const velodyne_packets_t& m) {
  if (m.num_packets < 1 || m.num_packets > kMaxVelodynePackets ||
      m.num_bytes != m.num_packets * kVelodynePacketBytes)
    return std::nullopt;
  std::vector<VelodynePacket> packets(static_cast<size_t>(m.num_packets));
  for (size_t i = 0; i < packets.size(); ++i) {
    packets[i].time = Time{m.packet_utime[i]};
    std::copy_n(m.data.begin() + static_cast<std::ptrdiff_t>(i * kVelodynePacketBytes), kVelodynePacketBytes,
                packets[i].bytes.begin());
  }
  return packets;
}

}  // namespace sgraphs
