#pragma once

#include <array>
#include <cstdint>
#include <span>

namespace sgraphs {

// The VLP-16's data packet (Velodyne VLP-16 User Manual 63-9243 rev. D, chapter 9): 12 blocks of 100 bytes
// (flag FF EE, azimuth, 32 channels of distance and reflectivity), stamp, two factory bytes.
inline constexpr int kVlp16PacketBytes = 1206;
inline constexpr int kVlp16Blocks = 12;
inline constexpr int kVlp16Lasers = 16;
inline constexpr int kVlp16FiringsPerBlock = 2;
inline constexpr double kVlp16Laser_us = 2.304;                       // from one laser to the next
inline constexpr double kVlp16Sequence_us = 55.296;                   // 16 lasers and a recharge
inline constexpr double kVlp16Block_us = 2 * kVlp16Sequence_us;       // 110.592
inline constexpr double kVlp16SinglePacket_us = 12 * kVlp16Block_us;  // 1327.104 from packet to packet
inline constexpr double kVlp16DualPacket_us = 6 * kVlp16Block_us;     // 663.552
inline constexpr double kVlp16RangeStep_m = 0.002;
inline constexpr uint16_t kVlp16Circle_cdeg = 36000;

enum class ReturnMode : uint8_t { kStrongest = 0x37, kLast = 0x38, kDual = 0x39 };

// Why a packet is refused, or kNone.
enum class PacketFault {
  kNone,
  kWrongSize,
  kWrongBlockFlag,
  kUnknownReturnMode,
  kNoAzimuth,
  kThirtyTwoBeams,
  kOutOfOrder,
  kStrayStamp,
};
inline constexpr int kNumPacketFaults = 8;
const char* toString(PacketFault fault);

// A packet that was accepted. It looks into the bytes it was parsed from.
struct Vlp16Packet {
  std::span<const uint8_t> bytes;
  ReturnMode mode = ReturnMode::kStrongest;
  bool factory_bytes_defined = true;  // false: firmware before 3.0.29.0; mode is then told by the azimuths
  uint32_t stamp_us = 0;              // first firing, past the hour of the sensor's clock
  // Azimuth of each block's first firing [0.01 deg], [0, 36000); values the sensor spoiled are interpolated.
  std::array<double, kVlp16Blocks> azimuth_cdeg{};
  int repaired_azimuths = 0;

  bool dual() const { return mode == ReturnMode::kDual; }
  double period_us() const { return dual() ? kVlp16DualPacket_us : kVlp16SinglePacket_us; }
  // Instant of a firing after the packet's first one.
  double firing_us(int block, int firing, int laser) const {
    const int sequence = kVlp16FiringsPerBlock * (dual() ? block / 2 : block) + firing;
    return kVlp16Sequence_us * sequence + kVlp16Laser_us * laser;
  }
  double lastFiring_us() const {
    return firing_us(kVlp16Blocks - 1, kVlp16FiringsPerBlock - 1, kVlp16Lasers - 1);
  }
  // In units of kVlp16RangeStep_m; 0: no return.
  uint16_t distance(int block, int firing, int laser) const;
  uint8_t reflectivity(int block, int firing, int laser) const;
};

// Azimuth field of a block as it stands in a packet of the right size; may be 36000 or above.
uint16_t rawAzimuth_cdeg(std::span<const uint8_t> packet, int block);

// Checks one UDP payload and reads what all its points share. The faults of a stream (kThirtyTwoBeams,
// kOutOfOrder) are PacketMonitor's.
PacketFault parsePacket(std::span<const uint8_t> bytes, Vlp16Packet& packet);

}  // namespace sgraphs
