#pragma once

#include <cstdint>

namespace sgraphs {

// A packet's stamp counts microseconds past the hour.
inline constexpr int64_t kHour_us = 3'600'000'000;
// UDP and capture repeat and reorder packets by less than this; a larger step back is the sensor's clock set
// anew.
inline constexpr int64_t kMaxReorder_us = 100'000;

}  // namespace sgraphs
