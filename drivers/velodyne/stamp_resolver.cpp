#include "drivers/velodyne/stamp_resolver.h"

#include <cstdlib>
#include <stdexcept>

#include "drivers/velodyne/packet_stamps.h"

namespace sgraphs {
namespace {

// Packets wait in buffers for less than this between sensor and host, and a host that keeps time at all is
// right to this. A wider gate would take more of the sensors that count from power-up for synchronised ones:
// of those one in 180 still is, by chance, and then wrong by less than this.
constexpr int64_t kMaxDelay_us = 10'000'000;

// The instant nearest to `near` that lies `past_hour_us` past some hour.
int64_t nearestHour(int64_t past_hour_us, int64_t near_us) {
  int64_t distance = (past_hour_us - near_us) % kHour_us;
  if (distance < -kHour_us / 2) distance += kHour_us;
  if (distance >= kHour_us / 2) distance -= kHour_us;
  return near_us + distance;
}

}  // namespace

void StampResolver::anchor(uint32_t stamp_us, Time host) {
  const int64_t as_utc_us = nearestHour(stamp_us, host.us);
  synchronised_ = clock_ == Clock::kAuto && std::abs(as_utc_us - host.us) <= kMaxDelay_us;
  offset_us_ = synchronised_ ? 0 : host.us - static_cast<int64_t>(stamp_us);
  anchored_ = true;
  previous_ = synchronised_ ? Time{as_utc_us} : host;
}

Time StampResolver::resolve(uint32_t stamp_us, std::optional<Time> host) {
  if (!anchored_) {
    if (!host) throw std::logic_error("StampResolver: the first packet needs a host time");
    anchor(stamp_us, *host);
    return previous_;
  }
  const int64_t sensor_us = static_cast<int64_t>(stamp_us) + offset_us_;
  const Time resolved{nearestHour(sensor_us, host ? host->us : previous_.us)};
  if (host && !synchronised_ && std::abs((resolved - *host).us) > kMaxDelay_us &&
      std::abs((resolved - previous_).us) > kMaxDelay_us) {
    anchor(stamp_us, *host);
    ++clock_jumps_;
    return previous_;
  }
  previous_ = resolved;
  return resolved;
}

}  // namespace sgraphs
