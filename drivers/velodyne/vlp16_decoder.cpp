#include "drivers/velodyne/vlp16_decoder.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sgraphs {
namespace {

// By laser id, which is also the order of firing (manual rev. D, table 9-1): elevation, and height of the
// beam's origin above the optical centre.
constexpr std::array<double, kVlp16Lasers> kElevation_deg{-15, 1, -13, 3,  -11, 5,  -9, 7,
                                                          -7,  9, -5,  11, -3,  13, -1, 15};
constexpr std::array<double, kVlp16Lasers> kVerticalOffset_mm{11.2, -0.7, 9.7, -2.2, 8.1, -3.7, 6.6, -5.1,
                                                              5.1,  -6.6, 3.7, -8.1, 2.2, -9.7, 0.7, -11.2};
// At 5 Hz, the slowest speed of the sensor, a revolution takes 0.2 s; one of half a second has no end.
constexpr int64_t kMaxRevolution_us = 500'000;
constexpr double kMaxAzimuthStep_cdeg = 200.0;  // per block; 80 at 20 Hz

constexpr uint8_t ringOf(int laser) {
  return static_cast<uint8_t>(laser % 2 == 0 ? laser / 2 : kVlp16Lasers / 2 + laser / 2);
}

struct LaserTable {
  std::array<double, kVlp16Lasers> cos_elevation{}, sin_elevation{};
  LaserTable() {
    for (size_t laser = 0; laser < kVlp16Lasers; ++laser) {
      const double elevation_rad = kElevation_deg[laser] * std::numbers::pi / 180.0;
      cos_elevation[laser] = std::cos(elevation_rad);
      sin_elevation[laser] = std::sin(elevation_rad);
    }
  }
};

// Round to nearest; instants are positive.
int64_t roundUs(double us) {
  return std::llround(us);
}

}  // namespace

struct RevolutionAssembler::BlockTiming {
  Time first_firing;  // of the packet
  double azimuth_cdeg;
  double step_cdeg;
};

RevolutionAssembler::RevolutionAssembler(const Vlp16Config& config)
    : config_(config), cutter_(config.cut_azimuth_deg) {}

std::optional<LidarScan> RevolutionAssembler::step(Time first_firing, std::span<const uint8_t> bytes) {
  Vlp16Packet packet;
  PacketFault fault = parsePacket(bytes, packet);
  PacketMonitor::Verdict verdict;
  if (fault == PacketFault::kNone) {
    verdict = monitor_.step(first_firing, packet);
    fault = verdict.fault;
  }
  if (fault != PacketFault::kNone) {
    ++counts_.rejected[static_cast<size_t>(fault)];
    if (fault == PacketFault::kThirtyTwoBeams) drop();
    return std::nullopt;
  }
  ++counts_.packets;
  counts_.repaired_azimuths += packet.repaired_azimuths;
  counts_.undefined_factory_bytes += !packet.factory_bytes_defined;
  counts_.lost_packets += verdict.lost_before;
  if (verdict.clock_jumped_back || (previous_packet_ && tornBy(first_firing - *previous_packet_))) drop();
  lost_in_open_ += verdict.lost_before;
  previous_packet_ = first_firing;

  int cut = cutter_.step(bytes);
  if (cut >= 0 && packet.dual()) cut -= cut % 2;
  addBlocks(first_firing, packet, 0, cut < 0 ? kVlp16Blocks : cut);
  std::optional<LidarScan> finished;
  if (cut >= 0) {
    finished = close();
    // A gap before a cut at the first block may reach into both revolutions.
    if (cut == 0) lost_in_open_ = verdict.lost_before;
    addBlocks(first_firing, packet, cut, kVlp16Blocks);
  }
  rate_cdeg_per_us_ = azimuthStep_cdeg(packet, 0) / kVlp16Block_us;
  return finished;
}

// After a gap of a whole turn the azimuth no longer tells how many cuts were missed.
bool RevolutionAssembler::tornBy(Duration since_previous) const {
  return static_cast<double>(since_previous.us) * rate_cdeg_per_us_ >= kVlp16Circle_cdeg ||
         since_previous.us > kMaxRevolution_us;
}

void RevolutionAssembler::drop() {
  if (begun_ || !empty_) ++counts_.dropped_revolutions;
  begun_ = false;
  empty_ = true;
  open_ = LidarScan{};
  lost_in_open_ = 0;
  cutter_ = RevolutionCutter(config_.cut_azimuth_deg);
}

std::optional<LidarScan> RevolutionAssembler::close() {
  std::optional<LidarScan> finished;
  if (begun_ && !empty_) {
    finished = std::move(open_);
    const auto length_us = static_cast<int32_t>((finished->end - finished->begin).us);
    for (LidarPoint& point : finished->points) point.time_us -= length_us;
    finished->num_rings = kVlp16Lasers;
    finished->sequence = next_sequence_++;
    ++counts_.revolutions;
    lost_in_last_ = lost_in_open_;
  } else if (!empty_) {
    ++counts_.dropped_revolutions;
  }
  begun_ = true;
  empty_ = true;
  open_ = LidarScan{};
  lost_in_open_ = 0;
  return finished;
}

void RevolutionAssembler::addBlocks(Time first_firing, const Vlp16Packet& packet, int begin, int end) {
  for (int block = begin; block < end; ++block) {
    if (empty_) {
      open_.begin = first_firing + Duration{roundUs(packet.firing_us(block, 0, 0))};
      empty_ = false;
    }
    open_.end = first_firing + Duration{roundUs(packet.firing_us(block, 1, kVlp16Lasers - 1))};
    if (begun_) addBlock(first_firing, packet, block);
  }
  // A sensor that does not turn would fill one revolution for ever.
  if ((open_.end - open_.begin).us > kMaxRevolution_us) drop();
}

// Azimuth from this block to the next column. The last column reuses the step before it, and so does a step
// that no turning sensor makes.
double RevolutionAssembler::azimuthStep_cdeg(const Vlp16Packet& packet, int block) const {
  const int stride = packet.dual() ? 2 : 1;
  double step_cdeg = 0;
  for (int b = block % stride; b + stride < kVlp16Blocks; b += stride) {
    double next_cdeg =
        packet.azimuth_cdeg[static_cast<size_t>(b + stride)] - packet.azimuth_cdeg[static_cast<size_t>(b)];
    if (next_cdeg < 0) next_cdeg += kVlp16Circle_cdeg;
    if (next_cdeg <= kMaxAzimuthStep_cdeg) step_cdeg = next_cdeg;
    if (b >= block) break;
  }
  return step_cdeg;
}

void RevolutionAssembler::addBlock(Time first_firing, const Vlp16Packet& packet, int block) {
  // Of a dual pair, the even block holds the last return and the odd one the strongest (or the second
  // strongest, if the last is the strongest): the pair is worked on as one, in order of firing.
  if (packet.dual() && block % 2 == 1) return;
  const BlockTiming timing{first_firing, packet.azimuth_cdeg[static_cast<size_t>(block)],
                           azimuthStep_cdeg(packet, block)};
  for (int firing = 0; firing < kVlp16FiringsPerBlock; ++firing)
    for (int laser = 0; laser < kVlp16Lasers; ++laser) {
      addPoint(packet, block, firing, laser, timing);
      if (packet.dual() && packet.distance(block + 1, firing, laser) != packet.distance(block, firing, laser))
        addPoint(packet, block + 1, firing, laser, timing);
    }
}

void RevolutionAssembler::addPoint(const Vlp16Packet& packet, int block, int firing, int laser,
                                   const BlockTiming& timing) {
  static const LaserTable kTable;
  const double range_m = kVlp16RangeStep_m * packet.distance(block, firing, laser);
  if (range_m <= 0 || range_m < config_.min_range_m || range_m > config_.max_range_m) return;
  const double in_block_us = kVlp16Sequence_us * firing + kVlp16Laser_us * laser;
  const double azimuth_rad = (timing.azimuth_cdeg + timing.step_cdeg * in_block_us / kVlp16Block_us) *
                             (2.0 * std::numbers::pi / kVlp16Circle_cdeg);
  const auto l = static_cast<size_t>(laser);
  const double across_m = range_m * kTable.cos_elevation[l];
  LidarPoint point;
  point.position_lidar = Eigen::Vector3d(across_m * std::cos(azimuth_rad), -across_m * std::sin(azimuth_rad),
                                         range_m * kTable.sin_elevation[l] + 1e-3 * kVerticalOffset_mm[l])
                             .cast<float>();
  const int64_t since_begin_us = (timing.first_firing - open_.begin).us;
  point.time_us = static_cast<int32_t>(since_begin_us + roundUs(packet.firing_us(block, firing, laser)));
  // Counted in time, so that columns behind a gap keep their numbers.
  point.column = static_cast<uint16_t>(std::lround(
      (static_cast<double>(since_begin_us) + packet.firing_us(block, firing, 0)) / kVlp16Sequence_us));
  point.ring = ringOf(laser);
  point.reflectivity = packet.reflectivity(block, firing, laser);
  open_.points.push_back(point);
}

}  // namespace sgraphs
