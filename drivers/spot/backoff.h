#pragma once

#include <algorithm>

#include "common/base/time.h"

namespace sgraphs {

// Pauses between tries: each twice the one before, up to a longest one; without chance in them.
class Backoff {
 public:
  Backoff(Duration first, Duration longest)
      : first_(std::min(first, longest)), longest_(longest), next_(first_) {}

  Duration next() {
    const Duration pause = next_;
    next_ = std::min(Duration{2 * next_.us}, longest_);
    return pause;
  }
  void reset() { next_ = first_; }

 private:
  Duration first_, longest_, next_;
};

}  // namespace sgraphs
