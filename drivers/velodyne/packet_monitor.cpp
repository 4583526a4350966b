#include "drivers/velodyne/packet_monitor.h"

#include <cmath>

#include "drivers/velodyne/packet_stamps.h"

namespace sgraphs {
namespace {

constexpr double kHdl32Packet_us = 12 * 46.08;
constexpr double kVlp32Packet_us = 12 * 55.296;
constexpr double kStampTolerance_us = 4.0;

bool foreignStep(double step_us, const Vlp16Packet& packet) {
  if (std::abs(step_us - kHdl32Packet_us) < kStampTolerance_us) return true;
  return !packet.dual() && std::abs(step_us - kVlp32Packet_us) < kStampTolerance_us;
}

}  // namespace

PacketMonitor::Verdict PacketMonitor::step(Time first_firing, const Vlp16Packet& packet) {
  Verdict verdict;
  if (previous_) {
    const int64_t step_us = (first_firing - *previous_).us;
    if (step_us <= 0 && step_us > -kMaxReorder_us) {
      verdict.fault = PacketFault::kOutOfOrder;
      return verdict;
    }
    verdict.clock_jumped_back = step_us <= 0;
    const auto step = static_cast<double>(step_us);
    if (!thirtyTwoBeams()) foreign_in_a_row_ = foreignStep(step, packet) ? foreign_in_a_row_ + 1 : 0;
    // A step is as long as the packet that began it; the return mode may change within a stream.
    if (step_us > 0 && !foreignStep(step, packet)) {
      verdict.lost_before = std::max<int64_t>(0, std::llround(step / previous_period_us_) - 1);
      lost_ += verdict.lost_before;
    }
  }
  previous_ = first_firing;
  previous_period_us_ = packet.period_us();
  if (thirtyTwoBeams()) verdict.fault = PacketFault::kThirtyTwoBeams;
  return verdict;
}

}  // namespace sgraphs
