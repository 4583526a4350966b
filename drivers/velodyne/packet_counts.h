#pragma once

#include <array>
#include <cstdint>

#include "drivers/velodyne/vlp16_packet.h"

namespace sgraphs {

// What became of the datagrams of a source, recorded or live.
struct PacketCounts {
  int64_t accepted = 0;
  std::array<int64_t, kNumPacketFaults> rejected{};  // by PacketFault
  int64_t other_sensor = 0;                          // data packets of a second sensor's address
  int64_t position = 0;                              // position packets
  int64_t other_datagrams = 0;
  int64_t lost = 0;  // by the sensor's stamps
  int64_t repaired_azimuths = 0;
  int64_t undefined_factory_bytes = 0;

  void reject(PacketFault fault) { ++rejected[static_cast<size_t>(fault)]; }
  void accept(const Vlp16Packet& packet, int64_t lost_so_far) {
    ++accepted;
    lost = lost_so_far;
    repaired_azimuths += packet.repaired_azimuths;
    undefined_factory_bytes += !packet.factory_bytes_defined;
  }
};

}  // namespace sgraphs
