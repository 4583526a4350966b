#include "common/geometry/simplify_chain.h"

#include <utility>

namespace sgraphs {

void simplifyChain(const Polygon2d& corners, size_t first, size_t last, double tolerance_m,
                   std::vector<uint8_t>& stays) {
  std::vector<std::pair<size_t, size_t>> open{{first, last}};
  const size_t n = corners.size();
  while (!open.empty()) {
    const auto [a, b] = open.back();
    open.pop_back();
    double worst_m = tolerance_m;
    size_t at = 0;
    for (size_t i = a + 1; i < b; ++i) {
      const double d_m = distanceToSegment(corners[i % n], corners[a % n], corners[b % n]);
      if (d_m <= worst_m) continue;
      worst_m = d_m;
      at = i;
    }
    if (at == 0) continue;
    stays[at % n] = 1;
    open.emplace_back(a, at);
    open.emplace_back(at, b);
  }
}

}  // namespace sgraphs
