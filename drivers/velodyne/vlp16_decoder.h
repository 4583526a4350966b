#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "common/types/lidar_scan.h"
#include "drivers/velodyne/packet_monitor.h"
#include "drivers/velodyne/revolution_cutter.h"
#include "drivers/velodyne/vlp16_packet.h"

namespace sgraphs {

struct Vlp16Config {
  double cut_azimuth_deg = 0.0;  // in the sensor's azimuth, clockwise from its y axis, [0, 360)
  double min_range_m = 0.2;
  double max_range_m = 130.0;
};

struct Vlp16Counts {
  int64_t packets = 0;                               // accepted
  std::array<int64_t, kNumPacketFaults> rejected{};  // by PacketFault
  int64_t lost_packets = 0;                          // by the stamps
  int64_t revolutions = 0;                           // delivered
  int64_t dropped_revolutions = 0;                   // begun before the first cut, or torn by a long gap
  int64_t repaired_azimuths = 0;                     // azimuths of 36000 and above
  int64_t undefined_factory_bytes = 0;               // packets of old firmware
};

// VLP-16 packets in, complete revolutions out. Revolutions are cut between blocks where the azimuth passes
// the cut angle; what lies before the first cut is dropped. Coordinates: x forward (the sensor's y axis), y
// left, z up.
class RevolutionAssembler {
 public:
  explicit RevolutionAssembler(const Vlp16Config& config = {});

  // Takes the next packet, with the instant of its first firing; returns the revolution that it completes.
  std::optional<LidarScan> step(Time first_firing, std::span<const uint8_t> packet);

  const Vlp16Counts& counts() const { return counts_; }
  // Packets known to be missing in the revolution delivered last, or at its cuts.
  int64_t lostInLastRevolution() const { return lost_in_last_; }

  // All but the configuration; see StateArchive.
  void visitState(auto& archive) {
    archive(cutter_, monitor_, counts_, previous_packet_, rate_cdeg_per_us_, begun_, empty_, open_,
            lost_in_open_, lost_in_last_, next_sequence_);
  }

 private:
  struct BlockTiming;
  void addBlocks(Time first_firing, const Vlp16Packet& packet, int begin, int end);
  void addBlock(Time first_firing, const Vlp16Packet& packet, int block);
  void addPoint(const Vlp16Packet& packet, int block, int firing, int laser, const BlockTiming& timing);
  double azimuthStep_cdeg(const Vlp16Packet& packet, int block) const;
  std::optional<LidarScan> close();
  void drop();
  bool tornBy(Duration since_previous) const;

  Vlp16Config config_;
  RevolutionCutter cutter_;
  PacketMonitor monitor_;
  Vlp16Counts counts_;
  std::optional<Time> previous_packet_;
  double rate_cdeg_per_us_ = 0;  // of the newest packet
  bool begun_ = false;           // the first cut has been seen
  bool empty_ = true;            // no block of the open revolution so far
  LidarScan open_;               // its points' time_us count from open_.begin until it is closed
  int64_t lost_in_open_ = 0;
  int64_t lost_in_last_ = 0;
  int64_t next_sequence_ = 0;
};

}  // namespace sgraphs
