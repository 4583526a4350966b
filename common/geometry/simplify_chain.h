#pragma once

#include <cstdint>
#include <vector>

#include "common/geometry/convex_polygon.h"

namespace sgraphs {

// Douglas and Peucker's simplification of the chain first..last of corners (indices modulo the size): marks
// in `stays` the corners between the two ends without which the chain would be off by more than the
// tolerance.
void simplifyChain(const Polygon2d& corners, size_t first, size_t last, double tolerance_m,
                   std::vector<uint8_t>& stays);

}  // namespace sgraphs
