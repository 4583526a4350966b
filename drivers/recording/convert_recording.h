#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/geometry/se3.h"
#include "drivers/recording/packet_source.h"
#include "drivers/recording/ros/ros_topics.h"

namespace sgraphs {

// What `sgraphs convert` was asked for; exactly one of pcap, raw, scans, bag and db3 is given.
struct ConvertOptions {
  std::string pcap;
  uint16_t data_port = PcapPacketSource::kDataPort;
  std::string raw;
  Time raw_start;  // first firing of the first packet
  std::string scans;
  std::string bag;           // of ROS 1
  std::string db3;           // of ROS 2
  WantedTopics topics;       // of a bag
  std::string odometry_tum;  // may be empty; takes the place of a bag's odometry
  SE3 T_body_lidar;
  std::string odometry_mode;  // may be empty
  std::string output;
};

struct ConvertReport {
  PacketCounts packets;
  int64_t revolutions = 0;  // complete ones
  int64_t scans = 0;
  int64_t odometry = 0;
  ChosenTopics topics;     // of a bag
  std::string body_frame;  // of a bag's odometry
  Time begin, end;         // of the LiDAR
  int64_t events = 0;
  int64_t session = 0;
  std::vector<std::string> warnings;
};

// Called now and then with the share done, 0 to 1.
using Progress = std::function<void(double)>;

// Merges the inputs in order of time into a log that ends with STREAM_END. The same inputs give the same
// bytes. The output appears only when it is complete; throws Error if nothing usable came out.
ConvertReport convertRecording(const ConvertOptions& options, const Progress& progress);

// "x y z qx qy qz qw" (blanks or commas). Throws UsageError.
SE3 parseTransform(const std::string& text, const std::string& option);

}  // namespace sgraphs
