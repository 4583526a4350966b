#pragma once

#include <cstdint>
#include <optional>

#include "common/base/time.h"

namespace sgraphs {

// Turns a packet's stamp (microseconds past the hour of the sensor's clock) into an instant. Intervals always
// come from the sensor; the host's time of arrival chooses the hour only. If the sensor's clock does not
// agree with the host's (no GPS: it counts from power-up), it is carried onto the host's clock by the
// difference seen at the first packet.
class StampResolver {
 public:
  enum class Clock {
    kAuto,     // told by the first packet
    kCarried,  // the first packet is at the host time given with it, whatever its stamp
  };
  explicit StampResolver(Clock clock = Clock::kAuto) : clock_(clock) {}

  // host: when the packet's first firing took place by the host's clock, roughly (arrival less the packet's
  // length). Without a host clock: once, for the first packet.
  Time resolve(uint32_t stamp_us, std::optional<Time> host);

  // The sensor's clock is the host's to within seconds: stamps count as true time.
  bool synchronised() const { return synchronised_; }
  // Times that the sensor's clock was set anew while it was being carried.
  int64_t clockJumps() const { return clock_jumps_; }

 private:
  void anchor(uint32_t stamp_us, Time host);

  Clock clock_;
  bool anchored_ = false;
  bool synchronised_ = false;
  int64_t offset_us_ = 0;  // added to sensor time, modulo one hour; 0 if synchronised
  Time previous_;
  int64_t clock_jumps_ = 0;
};

}  // namespace sgraphs
