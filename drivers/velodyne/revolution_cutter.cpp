#include "drivers/velodyne/revolution_cutter.h"

#include <cmath>

#include "drivers/velodyne/vlp16_packet.h"

namespace sgraphs {
namespace {

// The encoder may step back by a few hundredths of a degree; a larger step back is a way forward that was
// not seen.
constexpr double kMaxBackStep_deg = 2.0;

double wrap360(double deg) {
  const double wrapped = std::fmod(deg, 360.0);
  return wrapped < 0 ? wrapped + 360.0 : wrapped;
}

}  // namespace

RevolutionCutter::RevolutionCutter(double cut_azimuth_deg) : cut_azimuth_deg_(wrap360(cut_azimuth_deg)) {}

int RevolutionCutter::step(std::span<const uint8_t> packet) {
  if (packet.size() != kVlp16PacketBytes) return -1;
  int cut = -1;
  for (int block = 0; block < kVlp16Blocks; ++block) {
    const uint16_t raw = rawAzimuth_cdeg(packet, block);
    if (raw >= kVlp16Circle_cdeg) continue;
    const double past_cut_deg = wrap360(0.01 * raw - cut_azimuth_deg_);
    if (has_previous_) {
      const double forward_deg = wrap360(past_cut_deg - previous_deg_);
      if (forward_deg > 360.0 - kMaxBackStep_deg) continue;
      if (past_cut_deg < previous_deg_ && cut < 0) cut = block;
    }
    previous_deg_ = past_cut_deg;
    has_previous_ = true;
  }
  return cut;
}

}  // namespace sgraphs
