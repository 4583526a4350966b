#include "drivers/spot/stamp_mapper.h"

#include <algorithm>
#include <cstdlib>
#include <utility>

namespace sgraphs {

bool StampMapper::setSkew(Duration skew) {
  target_ = skew;
  if (has_skew_ && std::abs((target_.us - skew_.us)) <= max_slew_.us) return false;
  skew_ = target_;
  last_robot_.reset();
  return std::exchange(has_skew_, true);
}

std::optional<Time> StampMapper::step(Time robot) {
  if (last_robot_ && robot > *last_robot_) {
    const auto limit = static_cast<int64_t>(slew_ * static_cast<double>((robot - *last_robot_).us));
    skew_.us += std::clamp((target_.us - skew_.us), -limit, limit);
  }
  const Time host = toHost(robot);
  if (last_host_ && host <= *last_host_) return std::nullopt;
  last_robot_ = robot;
  last_host_ = host;
  return host;
}

}  // namespace sgraphs
