#pragma once

#include <cstdint>
#include <deque>
#include <optional>

#include "common/base/time.h"

namespace sgraphs {

// What is added to a free-running clock so that it reads the host's. A packet is late by what it waited on
// its way, never early: the smallest difference of the last seconds is the clocks' own (a lower envelope).
// The offset in force follows it slowly, so that intervals stay the sensor's.
class ClockOffsetFilter {
 public:
  // Seconds over which the smallest difference is taken: long enough to meet a packet that did not wait, and
  // clocks 50 ppm apart drift by 0.4 ms in it.
  static constexpr int kBlocks = 8;
  // The offset in force approaches the envelope with this time constant, and never faster than 5 ms per
  // second.
  static constexpr double kFollow_s = 2.0;
  static constexpr double kMaxSlew = 0.005;

  // sensor: the free-running clock, increasing; difference: host's clock less the sensor's. Returns the
  // offset in force.
  Duration step(Time sensor, Duration difference);
  // The clocks were set anew: from now on this is their difference.
  void restart(Time sensor, Duration difference);

 private:
  std::deque<int64_t> minima_us_;  // per block of a second, the newest last
  Time block_begin_, previous_;
  double offset_us_ = 0;
};

// When the packets of a live VLP-16 were fired. Intervals come from the sensor's clock (microseconds past the
// hour), unless the host's are asked for. What it publishes never runs backwards: a clock that is set back is
// not followed.
//
// A stamp that disagrees with the host by more than a second is stray until a second packet agrees with it:
// then the sensor's clock was set anew.
class PacketClock {
 public:
  enum class Mode {
    kAuto,    // the sensor's clock, carried onto the host's by ClockOffsetFilter
    kHost,    // arrival at the host, with its jitter
    kDevice,  // the sensor's clock is right (GPS); the host only chooses the hour
  };
  explicit PacketClock(Mode mode) : mode_(mode) {}

  struct Stamp {
    Time sensor;                    // the sensor's own clock, continuous over hours and settings
    std::optional<Time> published;  // nothing: repeated, late or stray
    bool stray = false;
  };
  // host: first firing by the host's clock, from the time of arrival.
  Stamp step(uint32_t stamp_us, Time host);

  int64_t sensorJumps() const { return sensor_jumps_; }
  int64_t hostJumps() const { return host_jumps_; }

 private:
  // A stamp and the host's clock at it.
  struct Reading {
    int64_t stamp_us = 0;
    Time host;
  };
  enum class Kind { kFollows, kHostSet, kStray, kSensorSet };
  Kind classify(const Reading& now) const;
  void setDeviceShift(const Reading& now, Time sensor);
  Time publish(const Reading& now, Time sensor);

  Mode mode_;
  std::optional<Reading> previous_, stray_;
  Time sensor_;               // of the packet before
  Duration host_correction_;  // added to the host's clock since it was set back
  Duration device_shift_;     // added to the sensor's time to read as its stamps say
  ClockOffsetFilter offset_;  // added to the sensor's time to read as the host's clock
  std::optional<Time> newest_;
  int64_t sensor_jumps_ = 0, host_jumps_ = 0;
};

}  // namespace sgraphs
