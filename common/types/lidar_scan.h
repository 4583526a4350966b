#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "common/base/time.h"

namespace sgraphs {

// One return in the lidar frame at its own firing (not deskewed).
struct LidarPoint {
  Eigen::Vector3f position_lidar = Eigen::Vector3f::Zero();  // [m]
  int32_t time_us = 0;       // firing relative to the scan's end, zero or negative
  uint16_t column = 0;       // index of the firing sequence within the scan; 0 if the LiDAR has none
  uint8_t ring = 0;          // bottom to top; 0 if the LiDAR has none
  uint8_t reflectivity = 0;  // 0-100 diffuse, 101-255 retro-reflective (VLP-16 manual)

  void visitState(auto& archive) { archive(position_lidar, time_us, column, ring, reflectivity); }
};

// One revolution (or sweep) in firing order. Its time is its end: the last firing.
struct LidarScan {
  Time begin;                      // first firing
  Time end;                        // last firing; scan.end - scan.begin is about 0.1 s at 600 rpm
  int64_t sequence = 0;            // revolution or sweep number of the source
  uint16_t num_rings = 0;          // 16 for a VLP-16; 0: unorganised, ring and column mean nothing
  bool deskewed = false;           // true: the points are already at the scan's end (no firing times)
  std::vector<LidarPoint> points;  // returns only; zero ranges are dropped by the decoder

  void visitState(auto& archive) { archive(begin, end, sequence, num_rings, deskewed, points); }
};

}  // namespace sgraphs
