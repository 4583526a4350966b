#pragma once

#include <numbers>

namespace sgraphs {

inline constexpr double kDegree_rad = std::numbers::pi / 180;

}  // namespace sgraphs
