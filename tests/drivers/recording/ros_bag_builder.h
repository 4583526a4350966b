#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace sgraphs::test {

// A message of a bag, its bytes as they stand on ROS' wire.
struct BagMessage {
  std::string topic, type;  // type as ROS 1 spells it
  int64_t received_us;
  std::vector<uint8_t> bytes;
};

enum class BagCompression { kNone, kBz2, kLz4 };

// Written by rosbag's own library.
void writeRos1Bag(const std::string& path, const std::vector<BagMessage>& messages,
                  BagCompression compression = BagCompression::kNone);

// The tables of rosbag2's SQLite storage.
void writeDb3(const std::string& path, const std::vector<BagMessage>& messages);

}  // namespace sgraphs::test
