#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "common/geometry/se3.h"
#include "perception/free_space/keyframe_rays.h"

namespace sgraphs {

// Slices of height over the walking surface that every column has, from 0.1 m, where floors and their noise
// end. Where nothing else is said to 1.9 m, below the lintels of doors.
constexpr int kNumSlices = 9;
constexpr double kSlice_m = 0.2;
constexpr double kLowestSlice_m = 0.1;

// What one keyframe says of the columns around it; one bit per slice. Cell (x, y) of the window is cell
// (x0 + x, y0 + y) of the map: [x cell_m, (x + 1) cell_m).
struct KeyframeView {
  int x0 = 0, y0 = 0, size = 0;
  std::vector<uint16_t> hits;    // something ended a ray here
  std::vector<uint16_t> misses;  // a ray passed, and nothing ended one
  std::vector<uint8_t> walked;   // the robot's body has been here

  size_t index(int x, int y) const { return static_cast<size_t>(y * size + x); }
};

// Casts a keyframe's rays from a pose. The same rays from the same pose give the same view, bit by bit.
class RayCaster {
 public:
  RayCaster(double cell_m, double max_range_m, double slice_m = kSlice_m);

  // Valid until the next call.
  const KeyframeView& cast(const KeyframeRays& rays, const SE3& T_map_body, double surface_z_m);

 private:
  // Ends in cells of the window and in slices.
  void castRay(const Eigen::Vector3f& from, const Eigen::Vector3f& to, bool is_hit);
  void passThrough(const Eigen::Vector3f& from, const Eigen::Vector3f& direction, float t, float t_end);
  void markWalked(const Eigen::Vector3f& at);
  bool inside(const Eigen::Vector3f& p) const;

  double cell_m_, slice_m_;
  KeyframeView view_;
};

}  // namespace sgraphs
