#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "drivers/recording/ros/wire_reader.h"

namespace sgraphs {

struct RosTopic {
  std::string name;
  std::string type;  // as ROS 1 spells it: "sensor_msgs/PointCloud2"
  int64_t count = 0;
};

// A recording of ROS, read one topic at a time. Construction and next() throw Error, in one line with what to
// do, for what is no such recording, or damaged.
class RosBag {
 public:
  virtual ~RosBag() = default;

  // By name.
  virtual const std::vector<RosTopic>& topics() const = 0;
  // Begins anew with the messages of one topic, in order of recording.
  virtual void select(const std::string& topic) = 0;
  // Next message of the topic, valid until the next call; nothing at the end.
  virtual std::optional<WireReader> next() = 0;
  // The files that it is made of, for a digest.
  virtual std::vector<std::string> files() const = 0;
};

// ROS 1: F.bag, also compressed.
std::unique_ptr<RosBag> openRos1Bag(const std::string& path);
// ROS 2: F.db3, or a folder that holds the parts of one recording.
std::unique_ptr<RosBag> openRos2Bag(const std::string& path);

// What the file's first bytes say it is, if that is a kind of recording that is not read, or by another
// option: "…: is an MCAP file, which is not read; …". Nothing for the kind that is expected, or an unknown
// one. Throws Error if the file cannot be read, or is empty.
enum class RecordingKind { kRos1Bag, kSqlite };
std::optional<std::string> complaintAbout(const std::string& path, RecordingKind expected);

}  // namespace sgraphs
