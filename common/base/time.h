#pragma once

#include <compare>
#include <cstdint>

namespace sgraphs {

// A length of sensor time, in whole microseconds.
struct Duration {
  int64_t us = 0;

  static constexpr Duration fromSeconds(double s) {
    return {static_cast<int64_t>(s * 1e6 + (s >= 0 ? 0.5 : -0.5))};
  }
  constexpr double seconds() const { return static_cast<double>(us) * 1e-6; }
  constexpr auto operator<=>(const Duration&) const = default;
};

// An instant of sensor time: microseconds since the Unix epoch. Seconds in a double lose microseconds, so
// they never cross an interface; only text files spell them out.
struct Time {
  int64_t us = 0;

  constexpr auto operator<=>(const Time&) const = default;
};

constexpr Duration operator-(Time a, Time b) {
  return {a.us - b.us};
}
constexpr Time operator+(Time t, Duration d) {
  return {t.us + d.us};
}
constexpr Time operator-(Time t, Duration d) {
  return {t.us - d.us};
}

}  // namespace sgraphs
