#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/channels.h"
#include "common/bus/log_file.h"
#include "lcmtypes/convert/convert.h"

namespace sgraphs::test {

inline constexpr int64_t kLogStart_us = 1'700'000'000'000'000;  // of logs that tests write

// Everything a log holds, decoded.
struct LogContents {
  std::vector<std::string> order;  // channel of each event
  std::vector<int64_t> stamps;
  std::vector<session_t> sessions;
  std::vector<velodyne_packets_t> packets;
  std::vector<lidar_points_t> points;
  std::vector<spot_odometry_t> odometry;
  std::vector<pose_t> poses;  // of POSE_SPOT
  std::optional<stream_end_t> end;
};

template <typename Message>
Message decoded(const LogEvent& event) {
  Message message{};
  EXPECT_TRUE(decode(event.bytes, message)) << event.channel;
  return message;
}

inline LogContents readLog(const std::string& path) {
  LogContents log;
  LogReader reader(path);
  while (const auto event = reader.next()) {
    log.order.push_back(event->channel);
    log.stamps.push_back(event->timestamp_us);
    if (event->channel == "SESSION") log.sessions.push_back(decoded<session_t>(*event));
    if (event->channel == "VELODYNE_PACKETS") log.packets.push_back(decoded<velodyne_packets_t>(*event));
    if (event->channel == "LIDAR_POINTS") log.points.push_back(decoded<lidar_points_t>(*event));
    if (event->channel == "SPOT_ODOMETRY") log.odometry.push_back(decoded<spot_odometry_t>(*event));
    if (event->channel == "POSE_SPOT") log.poses.push_back(decoded<pose_t>(*event));
    if (event->channel == "STREAM_END") log.end = decoded<stream_end_t>(*event);
  }
  return log;
}

}  // namespace sgraphs::test
