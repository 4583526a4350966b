#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

namespace sgraphs::simulate {

// Pseudo-random numbers that depend on (seed, stream) alone, so that work may be done in any order:
// SplitMix64 (Steele, Lea and Flood, "Fast splittable pseudorandom number generators", 2014). The standard
// library's distributions differ between implementations; these do not.
class RandomStream {
 public:
  RandomStream(uint64_t seed, uint64_t stream) : state_(mix(seed + kGolden) ^ mix(stream * kGolden + 1)) {}

  // Uniform in [0, 1).
  double uniform() { return static_cast<double>(next() >> 11) * 0x1.0p-53; }

  // Standard normal, by Box and Muller.
  double normal() {
    if (has_spare_) {
      has_spare_ = false;
      return spare_;
    }
    const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));
    const double angle = 2.0 * std::numbers::pi * uniform();
    spare_ = radius * std::sin(angle);
    has_spare_ = true;
    return radius * std::cos(angle);
  }

 private:
  static constexpr uint64_t kGolden = 0x9e3779b97f4a7c15ULL;

  static uint64_t mix(uint64_t z) {
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
    return z ^ (z >> 31);
  }
  uint64_t next() { return mix(state_ += kGolden); }

  uint64_t state_;
  double spare_ = 0;
  bool has_spare_ = false;
};

}  // namespace sgraphs::simulate
