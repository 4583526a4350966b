#include "drivers/velodyne/packet_clock.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "drivers/velodyne/packet_stamps.h"

namespace sgraphs {
namespace {

constexpr int64_t kBlock_us = 1'000'000;
// Sensor and host may disagree about an interval by this much: packets that wait on their way, clocks apart.
constexpr int64_t kTolerance_us = 1'000'000;
constexpr double kToleranceShare = 0.001;
// Packets within this follow each other without a setting of the sensor's clock between them.
constexpr int64_t kFollows_us = 200'000;

// The interval congruent to `interval_us` modulo an hour that is nearest to `near_us`.
int64_t nearestInterval(int64_t interval_us, int64_t near_us) {
  const auto hours = static_cast<double>(near_us - interval_us) / static_cast<double>(kHour_us);
  return interval_us + kHour_us * std::llround(hours);
}

bool agree(int64_t a_us, int64_t b_us) {
  const double tolerance =
      static_cast<double>(kTolerance_us) + kToleranceShare * std::abs(static_cast<double>(b_us));
  return std::abs(static_cast<double>(a_us - b_us)) <= tolerance;
}

}  // namespace

void ClockOffsetFilter::restart(Time sensor, Duration difference) {
  minima_us_ = {difference.us};
  block_begin_ = previous_ = sensor;
  offset_us_ = static_cast<double>(difference.us);
}

Duration ClockOffsetFilter::step(Time sensor, Duration difference) {
  if (minima_us_.empty()) restart(sensor, difference);
  if ((sensor - block_begin_).us >= kBlock_us) {
    minima_us_.push_back(difference.us);
    block_begin_ = sensor;
    if (minima_us_.size() > kBlocks) minima_us_.pop_front();
  }
  minima_us_.back() = std::min(minima_us_.back(), difference.us);
  const auto envelope_us = static_cast<double>(*std::min_element(minima_us_.begin(), minima_us_.end()));
  const double elapsed_s = (sensor - previous_).seconds();
  const double most_us = 1e6 * kMaxSlew * elapsed_s;
  const double share = std::min(1.0, elapsed_s / kFollow_s);
  offset_us_ += std::clamp(share * (envelope_us - offset_us_), -most_us, most_us);
  previous_ = sensor;
  return {std::llround(offset_us_)};
}

PacketClock::Kind PacketClock::classify(const Reading& now) const {
  const int64_t host_us = (now.host - previous_->host).us;
  if (agree(nearestInterval(now.stamp_us - previous_->stamp_us, host_us), host_us)) return Kind::kFollows;
  const int64_t plain_us = nearestInterval(now.stamp_us - previous_->stamp_us, 0);
  if (plain_us > -kMaxReorder_us && plain_us < kFollows_us) return Kind::kHostSet;
  if (!stray_) return Kind::kStray;
  const int64_t since_stray_us = (now.host - stray_->host).us;
  const bool confirmed =
      agree(nearestInterval(now.stamp_us - stray_->stamp_us, since_stray_us), since_stray_us);
  return confirmed ? Kind::kSensorSet : Kind::kStray;
}

void PacketClock::setDeviceShift(const Reading& now, Time sensor) {
  const Time told{nearestInterval(now.stamp_us, now.host.us)};
  device_shift_ = std::max(told, newest_ ? *newest_ + Duration{1} : told) - sensor;
}

Time PacketClock::publish(const Reading& now, Time sensor) {
  Time time = now.host;
  if (mode_ == Mode::kDevice) time = sensor + device_shift_;
  if (mode_ == Mode::kAuto) time = sensor + offset_.step(sensor, now.host - sensor);
  if (newest_) time = std::max(time, *newest_ + Duration{1});
  newest_ = time;
  return time;
}

PacketClock::Stamp PacketClock::step(uint32_t stamp_us, Time host) {
  Reading now{stamp_us, host + host_correction_};
  if (!previous_) {
    sensor_ = now.host;
    setDeviceShift(now, sensor_);
    previous_ = now;
    return {sensor_, publish(now, sensor_)};
  }
  const Kind kind = classify(now);
  if (kind == Kind::kStray) {
    stray_ = now;
    return {sensor_, std::nullopt, true};
  }
  stray_.reset();
  const int64_t host_us = (now.host - previous_->host).us;
  int64_t step_us = nearestInterval(now.stamp_us - previous_->stamp_us, host_us);
  if (kind == Kind::kSensorSet) step_us = std::max<int64_t>(1, host_us);
  if (kind == Kind::kHostSet) step_us = nearestInterval(now.stamp_us - previous_->stamp_us, 0);
  const Time sensor = sensor_ + Duration{step_us};
  if (step_us <= 0) return {sensor, std::nullopt};  // repeated or overtaken
  if (kind == Kind::kSensorSet) {
    ++sensor_jumps_;
    setDeviceShift(now, sensor);
    offset_.restart(sensor, now.host - sensor);
  }
  if (kind == Kind::kHostSet) {
    ++host_jumps_;
    if (host_us < step_us) {
      const Duration back{step_us - host_us};
      host_correction_ = Duration{host_correction_.us + back.us};
      now.host = now.host + back;
    } else {
      offset_.restart(sensor, now.host - sensor);
    }
  }
  sensor_ = sensor;
  previous_ = now;
  return {sensor, publish(now, sensor)};
}

}  // namespace sgraphs
