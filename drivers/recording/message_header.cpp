#include "drivers/recording/message_header.h"

#include <cstring>
#include <map>
#include <string>

#include "common/bus/channels.h"

namespace sgraphs {
namespace {

// An LCM message begins with the fingerprint of its type; our header is the first member behind it.
constexpr size_t kFingerprintBytes = 8;
constexpr size_t kSequenceOffset = kFingerprintBytes + 16;

int64_t fingerprintOf(const std::string& type) {
  static const std::map<std::string, int64_t> kFingerprints{
      {"graph_update_t", graph_update_t::getHash()},
      {"keyframe_t", keyframe_t::getHash()},
      {"lidar_points_t", lidar_points_t::getHash()},
      {"map_to_odom_t", map_to_odom_t::getHash()},
      {"odometry_t", odometry_t::getHash()},
      {"pose_t", pose_t::getHash()},
      {"round_schedule_t", round_schedule_t::getHash()},
      {"run_result_t", run_result_t::getHash()},
      {"session_t", session_t::getHash()},
      {"spot_odometry_t", spot_odometry_t::getHash()},
      {"status_t", status_t::getHash()},
      {"stream_end_t", stream_end_t::getHash()},
      {"velodyne_packets_t", velodyne_packets_t::getHash()},
  };
  return kFingerprints.at(type);
}

int64_t readBig64(const uint8_t* p) {
  uint64_t value = 0;
  for (int i = 0; i < 8; ++i) value = value << 8 | p[i];
  return static_cast<int64_t>(value);
}

}  // namespace

bool hasTypeOf(const LogEvent& event) {
  const channels::Row* row = channels::find(event.channel.c_str());
  return row && event.bytes.size() >= kFingerprintBytes &&
         readBig64(event.bytes.data()) == fingerprintOf(row->type);
}

std::optional<header_t> readHeader(const LogEvent& event) {
  const channels::Row* row = channels::find(event.channel.c_str());
  if (!hasTypeOf(event) || std::string(row->type) == "pose_t") return std::nullopt;
  header_t header{};
  const auto size = static_cast<int>(event.bytes.size() - kFingerprintBytes);
  if (header._decodeNoHash(event.bytes.data(), kFingerprintBytes, size) < 0) return std::nullopt;
  return header;
}

void setSequence(LogEvent& event, int64_t seq) {
  for (size_t i = 0; i < 8; ++i)
    event.bytes[kSequenceOffset + i] = static_cast<uint8_t>(static_cast<uint64_t>(seq) >> (56 - 8 * i));
}

}  // namespace sgraphs
