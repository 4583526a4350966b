#include "common/io/canvas.h"

#include <algorithm>
#include <cmath>

namespace sgraphs {

Color viridis(double s) {
  // Nine evenly spaced samples of the published table, linear between.
  static constexpr double kTable[9][3] = {{68, 1, 84},    {71, 44, 122},  {59, 81, 139},
                                          {44, 113, 142}, {33, 144, 141}, {39, 173, 129},
                                          {92, 200, 99},  {170, 220, 50}, {253, 231, 37}};
  const double x = std::clamp(std::isfinite(s) ? s : 0.0, 0.0, 1.0) * 8;
  const int i = std::min(static_cast<int>(x), 7);
  const auto mix = [&](int c) {
    return static_cast<uint8_t>(std::lround(kTable[i][c] + (x - i) * (kTable[i + 1][c] - kTable[i][c])));
  };
  return {mix(0), mix(1), mix(2)};
}

}  // namespace sgraphs
