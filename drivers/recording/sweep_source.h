#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/types/lidar_scan.h"

namespace sgraphs {

// Whole sweeps of a recording of any LiDAR, in order of time.
class SweepSource {
 public:
  virtual ~SweepSource() = default;

  // Next sweep; nothing at the end.
  virtual std::optional<LidarScan> next() = 0;
  virtual double progress() const = 0;  // 0 to 1
  // One line each, of what the user ought to know once the end is reached.
  virtual std::vector<std::string> warnings() const { return {}; }
  // What the recording held instead, for the error that nothing came out of it.
  virtual std::string whyNothing() const = 0;
};

}  // namespace sgraphs
