#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "common/types/keyframe.h"
#include "perception/loops/place_patches.h"

namespace sgraphs {

// What comparing one cloud with what another keyframe saw gives, in patches.
struct SightCounts {
  int total = 0;        // all
  int seen = 0;         // in the other's field, and not hidden from it by what it saw
  int agreeing = 0;     // of these: lie where the other sees a surface
  int conflicting = 0;  // of these: stand where the other saw through

  double overlap() const { return total > 0 ? static_cast<double>(seen) / total : 0; }
  double agreement() const { return seen > 0 ? static_cast<double>(agreeing) / seen : 0; }
  double conflict() const { return seen > 0 ? static_cast<double>(conflicting) / seen : 0; }
  void add(const SightCounts& other) {
    seen += other.seen;
    agreeing += other.agreeing;
    conflicting += other.conflicting;
    total += other.total;
  }
};

// How far a keyframe sees in each direction: ranges from its lidar, 2 degrees of azimuth by 3 of elevation in
// body. A wall that stands where another look at the place saw through it refutes that the places are one,
// however well the rest fits.
class Sight {
 public:
  explicit Sight(const Keyframe& keyframe);

  // Patches of another body against this one's ranges. T_body_other leads from the other body to this one.
  SightCounts compare(std::span<const PackedPatch> patches, const SE3& T_body_other) const;

  size_t bytes() const { return pixels_.capacity() * sizeof(Pixel); }

 private:
  static constexpr int kAzimuths = 180;
  static constexpr int kElevations = 16;
  static constexpr float kElevationStep_rad = 0.05236F;  // 3 degrees

  struct Pixel {
    uint16_t nearest_cm = 0;  // 0: nothing came back
    uint16_t farthest_cm = 0;
  };
  const Pixel& at(int azimuth, int elevation) const;

  Eigen::Vector3f lidar_body_;
  std::vector<Pixel> pixels_;
};

}  // namespace sgraphs
