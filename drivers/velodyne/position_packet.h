#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "common/base/time.h"

namespace sgraphs {

// The VLP-16's position packet (User Manual 63-9243 rev. D, chapter 9): what the sensor knows of a GPS
// receiver on its interface box, about once per 14 data packets, whether there is one or not.
inline constexpr int kPositionPacketBytes = 512;

// How the sensor's clock stands to the receiver's pulse per second. Old firmware always says kAbsent.
enum class PpsState : uint8_t { kAbsent = 0, kSynchronising = 1, kLocked = 2, kError = 3 };
const char* toString(PpsState state);

struct PositionPacket {
  uint32_t stamp_us = 0;  // past the hour of the sensor's clock
  PpsState pps = PpsState::kAbsent;
  std::string sentence;     // $GPRMC without its line end; empty: no receiver
  bool fix = false;         // the receiver knows where it is (status A), and the sentence's checksum is right
  std::optional<Time> utc;  // of the sentence, if it is whole and dated
};

// Nothing for bytes that are no position packet: wrong size, or a pulse state that does not exist.
std::optional<PositionPacket> parsePositionPacket(std::span<const uint8_t> bytes);

}  // namespace sgraphs
