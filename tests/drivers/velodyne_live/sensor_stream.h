#pragma once

#include <cstdint>
#include <vector>

#include "common/types/udp_datagram.h"
#include "tests/drivers/velodyne/packet_builder.h"

namespace sgraphs::test {

// Datagrams of a turning sensor whose stamps are true time past kHour_us.
class SensorStream {
 public:
  static constexpr int64_t kHour_us = 472'222 * int64_t{3'600'000'000};
  static constexpr uint16_t kDataPort = 2368, kPositionPort = 8308;

  explicit SensorStream(uint8_t last_byte = 201) : address_(0xC0A80100u + last_byte) {}

  TurningSensor sensor;

  UdpDatagram next() {
    const int64_t arrived_us = kHour_us + sensor.timeUs() + 1327;
    const PacketBytes bytes = sensor.next();
    return {Time{arrived_us}, address_, kDataPort, {bytes.begin(), bytes.end()}};
  }
  UdpDatagram datagram(std::vector<uint8_t> payload, uint16_t port = kDataPort) const {
    return {Time{kHour_us + sensor.timeUs() + 1327}, address_, port, std::move(payload)};
  }

 private:
  uint32_t address_;
};

}  // namespace sgraphs::test
