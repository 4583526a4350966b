#pragma once

#include <deque>
#include <optional>
#include <vector>

#include "common/types/lidar_scan.h"
#include "common/types/session.h"

namespace sgraphs {

// Holds a scan until its inputs are there. Without odometry a scan waits for nothing; with it scan s waits
// until a sample at or after its end has come, or scan s+10 exists, or the stream has ended. The order of
// arrival on one stream decides, never a clock.
class ScanQueue {
 public:
  static constexpr size_t kPatience = 10;       // scans that may arrive while one waits
  static constexpr size_t kMaxSamples = 20000;  // without scans the oldest samples go first

  enum class Fate {
    kKept,
    kBackwards,  // not after the one before it
    kLate,       // its scan went without it
  };
  struct Ready {
    LidarScan scan;
    std::vector<BodyOdometry>
        odometry;          // from the last at or before scan.begin to the first at or after its end
    bool complete = true;  // the samples reach the scan's end (or none are asked for)
  };

  explicit ScanQueue(bool waits_for_odometry) : waits_for_odometry_(waits_for_odometry) {}

  Fate addScan(LidarScan scan);
  Fate addOdometry(const BodyOdometry& sample);
  // How far the samples' stamps are ahead of the scans' clock, from now on: they are handed out, and waited
  // for, with it taken off. Smaller than 1 s.
  void setClockOffset(Duration offset) { offset_ = offset; }
  // Nothing more will arrive: every scan held is ready.
  void close() { closed_ = true; }
  // The oldest scan, if it is ready.
  std::optional<Ready> pop();

  // All but whether it waits; see StateArchive.
  void visitState(auto& archive) {
    archive(closed_, scans_, samples_, offset_, newest_scan_, newest_sample_, released_);
  }

  size_t size() const { return scans_.size(); }
  size_t samples() const { return samples_.size(); }

 private:
  std::vector<BodyOdometry> samplesFor(const LidarScan& scan);
  Time corrected(Time stamp) const { return stamp - offset_; }

  bool waits_for_odometry_;
  bool closed_ = false;
  std::deque<LidarScan> scans_;
  std::deque<BodyOdometry> samples_;  // as they are stamped
  Duration offset_;
  std::optional<Time> newest_scan_;
  std::optional<Time> newest_sample_, released_;  // by the samples' clock
};

}  // namespace sgraphs
