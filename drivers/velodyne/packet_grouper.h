#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "common/types/velodyne_packet.h"
#include "drivers/velodyne/revolution_cutter.h"

namespace sgraphs {

// Consecutive packets that travel in one message.
struct PacketGroup {
  std::vector<VelodynePacket> packets;
  int64_t revolution = 0;  // counts from 0
  int32_t part = 0;        // of its revolution, from 0
  bool last_part = false;  // its last packet holds the revolution's cut
};

// Collects packets into groups, alike for recordings and live sensors: at most 20 packets, closed with the
// packet that holds a revolution's cut. 20 packets are 25 kB and 26 ms: one datagram, and four groups per
// revolution at 600 rpm.
class PacketGrouper {
 public:
  static constexpr size_t kMaxPackets = 20;

  // cut_azimuth_deg as RevolutionCutter takes it.
  explicit PacketGrouper(double cut_azimuth_deg = 0.0) : cutter_(cut_azimuth_deg) {}

  // Takes the next packet; returns the group that it completes.
  std::optional<PacketGroup> step(const VelodynePacket& packet);
  // What waits, as a group that does not end its revolution; nothing if none does.
  std::optional<PacketGroup> flush();

 private:
  PacketGroup close(bool last_part);

  RevolutionCutter cutter_;
  PacketGroup open_;
};

}  // namespace sgraphs
