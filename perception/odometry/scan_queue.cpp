#include "perception/odometry/scan_queue.h"

#include <utility>

namespace sgraphs {
namespace {

// Samples this much older than needed stay, for an offset of the clocks that is found later.
constexpr Duration kLargestOffset{1'000'000};

}  // namespace

ScanQueue::Fate ScanQueue::addScan(LidarScan scan) {
  if ((newest_scan_ && scan.end <= *newest_scan_) || scan.begin > scan.end) return Fate::kBackwards;
  newest_scan_ = scan.end;
  scans_.push_back(std::move(scan));
  return Fate::kKept;
}

ScanQueue::Fate ScanQueue::addOdometry(const BodyOdometry& sample) {
  if (newest_sample_ && sample.time <= *newest_sample_) return Fate::kBackwards;
  newest_sample_ = sample.time;
  // A scan that was released without odometry up to its end leaves samples behind.
  if (released_ && sample.time <= *released_) return Fate::kLate;
  samples_.push_back(sample);
  if (samples_.size() > kMaxSamples) samples_.pop_front();
  return Fate::kKept;
}

std::optional<ScanQueue::Ready> ScanQueue::pop() {
  if (scans_.empty()) return std::nullopt;
  if (!waits_for_odometry_) {
    Ready ready{std::move(scans_.front()), {}, true};
    scans_.pop_front();
    return ready;
  }
  const bool complete = newest_sample_ && corrected(*newest_sample_) >= scans_.front().end;
  if (!complete && !closed_ && scans_.size() <= kPatience) return std::nullopt;
  Ready ready{std::move(scans_.front()), {}, complete};
  scans_.pop_front();
  ready.odometry = samplesFor(ready.scan);
  released_ = ready.scan.end + offset_;
  return ready;
}

std::vector<BodyOdometry> ScanQueue::samplesFor(const LidarScan& scan) {
  // Later scans begin later: what lies far before the last sample at or before this begin is not needed
  // again.
  const Time oldest = scan.begin - Duration{2 * kLargestOffset.us};
  while (samples_.size() >= 2 && samples_[1].time <= oldest) samples_.pop_front();
  std::vector<BodyOdometry> chosen;
  for (const BodyOdometry& sample : samples_) {
    const Time time = corrected(sample.time);
    if (time <= scan.begin) chosen.clear();
    chosen.push_back({time, sample.T_odom_body});
    if (time >= scan.end) break;
  }
  return chosen;
}

}  // namespace sgraphs
