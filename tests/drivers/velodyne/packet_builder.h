#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <vector>

#include "drivers/velodyne/vlp16_packet.h"

namespace sgraphs::test {

using PacketBytes = std::array<uint8_t, kVlp16PacketBytes>;

// Distance [2 mm] by block, firing, laser.
using DistanceOf = std::function<uint16_t(int block, int firing, int laser)>;

inline void putU16(PacketBytes& bytes, size_t at, unsigned value) {
  bytes[at] = static_cast<uint8_t>(value & 0xFF);
  bytes[at + 1] = static_cast<uint8_t>(value >> 8 & 0xFF);
}

inline void setAzimuth(PacketBytes& bytes, int block, unsigned azimuth_cdeg) {
  putU16(bytes, 100 * static_cast<size_t>(block) + 2, azimuth_cdeg);
}

inline void setStamp(PacketBytes& bytes, uint32_t stamp_us) {
  putU16(bytes, 1200, stamp_us & 0xFFFF);
  putU16(bytes, 1202, stamp_us >> 16);
}

inline PacketBytes makePacket(double first_azimuth_cdeg, double step_cdeg, uint32_t stamp_us, bool dual,
                              const DistanceOf& distance, uint8_t mode, uint8_t product) {
  PacketBytes bytes{};
  for (int block = 0; block < kVlp16Blocks; ++block) {
    const size_t at = 100 * static_cast<size_t>(block);
    bytes[at] = 0xFF;
    bytes[at + 1] = 0xEE;
    const int column = dual ? block / 2 : block;
    const double azimuth = std::fmod(first_azimuth_cdeg + step_cdeg * column, 36000.0);
    setAzimuth(bytes, block, static_cast<unsigned>(std::lround(azimuth)) % 36000);
    for (int firing = 0; firing < 2; ++firing)
      for (int laser = 0; laser < 16; ++laser) {
        const size_t channel = at + 4 + 3 * static_cast<size_t>(16 * firing + laser);
        putU16(bytes, channel, distance(block, firing, laser));
        bytes[channel + 2] = static_cast<uint8_t>(laser + 100 * (block % 2));
      }
  }
  setStamp(bytes, stamp_us);
  bytes[1204] = mode;
  bytes[1205] = product;
  return bytes;
}

// A sensor that turns at a constant rate and sees a surface at the same distance everywhere.
class TurningSensor {
 public:
  double rate_hz = 10;
  bool dual = false;
  double azimuth_cdeg = 0;
  double time_us = 0;  // of the next packet's first firing
  uint16_t distance = 2500;

  double step_cdeg() const { return 36000.0 * rate_hz * 1e-6 * kVlp16Block_us; }
  int columnsPerPacket() const { return dual ? 6 : 12; }

  // Microseconds past the hour are the same as time_us until the hour is over.
  PacketBytes next() {
    const auto stamp = static_cast<uint32_t>(std::llround(time_us) % 3'600'000'000);
    const PacketBytes bytes = makePacket(
        azimuth_cdeg, step_cdeg(), stamp, dual,
        [this](int block, int, int) { return static_cast<uint16_t>(distance + (dual ? block % 2 : 0)); },
        dual ? 0x39 : 0x37, 0x22);
    skip(1);
    return bytes;
  }
  void skip(int packets) {
    azimuth_cdeg = std::fmod(azimuth_cdeg + packets * columnsPerPacket() * step_cdeg(), 36000.0);
    time_us += packets * columnsPerPacket() * kVlp16Block_us;
  }
  int64_t timeUs() const { return std::llround(time_us); }
};

}  // namespace sgraphs::test
