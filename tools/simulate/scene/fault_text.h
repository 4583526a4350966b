#pragma once

#include <Eigen/Core>
#include <cstdio>
#include <string>

namespace sgraphs::simulate {

// How faults name numbers, places and items of a plan: 0.25, (1, 2.5), walls[3].
inline std::string text(double value) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%.4g", value);
  return buffer;
}

inline std::string text(const Eigen::Vector2d& xy) {
  return "(" + text(xy.x()) + ", " + text(xy.y()) + ")";
}

inline std::string item(const std::string& list, size_t index) {
  return list + "[" + std::to_string(index) + "]";
}

}  // namespace sgraphs::simulate
