#pragma once

#include <cstdint>
#include <optional>

#include "common/base/time.h"
#include "drivers/velodyne/vlp16_packet.h"

namespace sgraphs {

// Watches the instants of one sensor's packets: counts those lost between two of them, refuses repeated and
// late ones, and tells a 32-beam sensor by its rhythm. Such a sensor sends packets of the same form with
// another period (HDL-32E: 12 * 46.08 = 553 us; VLP-32C, single return: 664 us), and its model byte is also
// found on VLP-16s.
class PacketMonitor {
 public:
  struct Verdict {
    PacketFault fault = PacketFault::kNone;
    int64_t lost_before = 0;         // packets missing between this one and the one before
    bool clock_jumped_back = false;  // the sensor restarted: a new stretch of time begins
  };

  // Packets that passed parsePacket, in order of arrival, with the instant of the first firing.
  Verdict step(Time first_firing, const Vlp16Packet& packet);

  int64_t lost() const { return lost_; }
  void visitState(auto& archive) { archive(previous_, previous_period_us_, lost_, foreign_in_a_row_); }

  // Recognised as a 32-beam sensor; every packet is refused from then on.
  bool thirtyTwoBeams() const { return foreign_in_a_row_ >= kForeignSteps; }

 private:
  // A few steps in a row, so that one spoiled stamp condemns nobody.
  static constexpr int kForeignSteps = 3;

  std::optional<Time> previous_;
  double previous_period_us_ = 0;
  int64_t lost_ = 0;
  int foreign_in_a_row_ = 0;
};

}  // namespace sgraphs
