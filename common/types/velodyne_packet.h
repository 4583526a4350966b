#pragma once

#include <array>
#include <cstdint>

#include "common/base/time.h"

namespace sgraphs {

inline constexpr int kVelodynePacketBytes = 1206;

// A raw packet and the instant of its first firing.
struct VelodynePacket {
  Time time;
  std::array<uint8_t, kVelodynePacketBytes> bytes{};
};

}  // namespace sgraphs
