#pragma once

#include <algorithm>

namespace sgraphs {

// How long to wait before a process that ended is started again: 0.1 s, and twice as long each time up to 10
// s. A life of 30 s makes it a fresh start.
class RestartPolicy {
 public:
  static constexpr double kFirst_s = 0.1, kLongest_s = 10, kHealthyLife_s = 30;

  double delayAfter(double lived_s) {
    if (lived_s >= kHealthyLife_s) next_s_ = kFirst_s;
    const double delay_s = next_s_;
    next_s_ = std::min(2 * next_s_, kLongest_s);
    return delay_s;
  }

 private:
  double next_s_ = kFirst_s;
};

}  // namespace sgraphs
