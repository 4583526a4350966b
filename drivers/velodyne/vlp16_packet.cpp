#include "drivers/velodyne/vlp16_packet.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace sgraphs {
namespace {

constexpr size_t kBlockBytes = 100;
constexpr size_t kStampOffset = 1200;
constexpr size_t kReturnModeOffset = 1204;
constexpr size_t kProductOffset = 1205;

uint16_t readU16(std::span<const uint8_t> bytes, size_t at) {
  return static_cast<uint16_t>(bytes[at] | bytes[at + 1] << 8);
}

size_t channelOffset(int block, int firing, int laser) {
  return kBlockBytes * static_cast<size_t>(block) + 4 +
         3 * static_cast<size_t>(kVlp16Lasers * firing + laser);
}

// HDL-32E, VLP-16 and Puck LITE, Puck Hi-Res, VLP-32C. Recordings of a VLP-16 with old firmware carry 0x21,
// so the byte tells that the factory bytes mean something, and not which sensor it is.
bool knownProduct(uint8_t product) {
  return product == 0x21 || product == 0x22 || product == 0x24 || product == 0x28;
}

bool knownMode(uint8_t mode) {
  return mode >= static_cast<uint8_t>(ReturnMode::kStrongest) &&
         mode <= static_cast<uint8_t>(ReturnMode::kDual);
}

// Dual return repeats every azimuth in the next block; a turning sensor in single return never does so six
// times.
bool azimuthsInPairs(std::span<const uint8_t> bytes) {
  int pairs = 0;
  for (int block = 0; block < kVlp16Blocks; block += 2)
    pairs += rawAzimuth_cdeg(bytes, block) == rawAzimuth_cdeg(bytes, block + 1);
  return pairs == kVlp16Blocks / 2 && rawAzimuth_cdeg(bytes, 0) != rawAzimuth_cdeg(bytes, kVlp16Blocks - 1);
}

// Azimuths on the block's column (dual return: two blocks share one), unwrapped along the packet; those out
// of range lie on the line through their neighbours.
bool readAzimuths(Vlp16Packet& packet) {
  struct Known {
    int column;
    double azimuth_cdeg;
  };
  const auto columnOf = [&](int block) { return packet.dual() ? block / 2 : block; };
  std::vector<Known> known;
  for (int block = 0; block < kVlp16Blocks; ++block) {
    const uint16_t raw = rawAzimuth_cdeg(packet.bytes, block);
    if (raw >= kVlp16Circle_cdeg) continue;
    if (!known.empty() && known.back().column == columnOf(block)) continue;
    double azimuth = raw;
    if (!known.empty())
      azimuth = known.back().azimuth_cdeg +
                std::remainder(raw - known.back().azimuth_cdeg, double{kVlp16Circle_cdeg});
    known.push_back({columnOf(block), azimuth});
  }
  if (known.size() < 2) return false;
  for (int block = 0; block < kVlp16Blocks; ++block) {
    auto& azimuth = packet.azimuth_cdeg[static_cast<size_t>(block)];
    const uint16_t raw = rawAzimuth_cdeg(packet.bytes, block);
    if (raw < kVlp16Circle_cdeg) {
      azimuth = raw;
      continue;
    }
    ++packet.repaired_azimuths;
    // The neighbours on both sides, or the two nearest at an end of the packet.
    auto right =
        std::find_if(known.begin(), known.end(), [&](const Known& k) { return k.column >= columnOf(block); });
    right = std::clamp(right, known.begin() + 1, known.end() - 1);
    const Known &a = *(right - 1), &b = *right;
    const double slope = (b.azimuth_cdeg - a.azimuth_cdeg) / (b.column - a.column);
    const double value = a.azimuth_cdeg + slope * (columnOf(block) - a.column);
    azimuth = value - kVlp16Circle_cdeg * std::floor(value / kVlp16Circle_cdeg);
  }
  return true;
}

}  // namespace

const char* toString(PacketFault fault) {
  switch (fault) {
    case PacketFault::kNone:
      return "none";
    case PacketFault::kWrongSize:
      return "not 1206 bytes";
    case PacketFault::kWrongBlockFlag:
      return "wrong block flag";
    case PacketFault::kUnknownReturnMode:
      return "unknown return mode";
    case PacketFault::kNoAzimuth:
      return "no valid azimuth";
    case PacketFault::kThirtyTwoBeams:
      return "32-beam sensor";
    case PacketFault::kOutOfOrder:
      return "repeated or out of order";
    case PacketFault::kStrayStamp:
      return "stamp far from those around it";
  }
  return "unknown";
}

uint16_t rawAzimuth_cdeg(std::span<const uint8_t> packet, int block) {
  return readU16(packet, kBlockBytes * static_cast<size_t>(block) + 2);
}

uint16_t Vlp16Packet::distance(int block, int firing, int laser) const {
  return readU16(bytes, channelOffset(block, firing, laser));
}

uint8_t Vlp16Packet::reflectivity(int block, int firing, int laser) const {
  return bytes[channelOffset(block, firing, laser) + 2];
}

PacketFault parsePacket(std::span<const uint8_t> bytes, Vlp16Packet& packet) {
  packet = Vlp16Packet{};
  if (bytes.size() != kVlp16PacketBytes) return PacketFault::kWrongSize;
  for (size_t block = 0; block < kVlp16Blocks; ++block)
    if (bytes[kBlockBytes * block] != 0xFF || bytes[kBlockBytes * block + 1] != 0xEE)
      return PacketFault::kWrongBlockFlag;
  packet.bytes = bytes;
  const uint8_t mode = bytes[kReturnModeOffset];
  if (knownMode(mode)) {
    packet.mode = static_cast<ReturnMode>(mode);
  } else {
    if (knownProduct(bytes[kProductOffset])) return PacketFault::kUnknownReturnMode;
    packet.factory_bytes_defined = false;
    packet.mode = azimuthsInPairs(bytes) ? ReturnMode::kDual : ReturnMode::kStrongest;
  }
  packet.stamp_us = static_cast<uint32_t>(readU16(bytes, kStampOffset)) |
                    static_cast<uint32_t>(readU16(bytes, kStampOffset + 2)) << 16;
  return readAzimuths(packet) ? PacketFault::kNone : PacketFault::kNoAzimuth;
}

}  // namespace sgraphs
