#pragma once

#include <chrono>

#include "common/base/time.h"

namespace sgraphs {

// The host's clock. It stamps what enters a live driver, and nothing behind the drivers reads it.
inline Time hostClock() {
  using namespace std::chrono;
  return {duration_cast<microseconds>(system_clock::now().time_since_epoch()).count()};
}

}  // namespace sgraphs
