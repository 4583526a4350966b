#pragma once

#include <vector>

#include "common/types/keyframe.h"
#include "perception/odometry/surfel.h"

namespace sgraphs {

// Planar patches of a keyframe's cloud in its body, normals towards the viewpoints: one per cube and viewing
// direction, cubes of 0.4, 0.8 and 1.6 m at distances up to 8, 16 and 40 m, where the beams lie that far
// apart. At most `max_upright` walls and `max_level` floors and ceilings, evenly thinned. In the order of
// the cloud's points.
std::vector<Surfel> patchesOf(const Keyframe& keyframe, size_t max_upright, size_t max_level);

// A patch at 56 bytes instead of 144: what a registration asks of it.
class PackedPatch {
 public:
  explicit PackedPatch(const Surfel& surfel);
  Surfel unpack() const;

  const Eigen::Vector3f& mean() const { return mean_; }
  const Eigen::Vector3f& normal() const { return normal_; }

 private:
  Eigen::Vector3f mean_;
  Eigen::Vector3f normal_;
  float covariance_[6];  // upper triangle, row by row
  float variance_m2_;
  float count_;
};

}  // namespace sgraphs
