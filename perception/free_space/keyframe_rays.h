#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "common/types/keyframe.h"

namespace sgraphs {

// What a keyframe's cloud says of free space, thinned and compact, so that it can be cast again from another
// pose. In the keyframe's body frame.
struct KeyframeRays {
  struct Ray {
    std::array<int16_t, 3> end_cm{};
    uint8_t viewpoint = 0;
    bool is_hit = false;  // false: nothing up to here, and not followed farther
  };
  std::vector<Eigen::Vector3f> viewpoints_body;  // [m]
  std::vector<Ray> rays;

  size_t bytes() const {
    return sizeof(*this) + viewpoints_body.capacity() * sizeof(Eigen::Vector3f) +
           rays.capacity() * sizeof(Ray);
  }
};

// Rays of a keyframe that end in the same place and come from the same place are one ray.
class RayThinner {
 public:
  RayThinner(double cell_m, double max_range_m);
  // Rays to the floor and to the ceiling only clear what they pass: they are thinned more where the height of
  // the body over the walking surface is known.
  KeyframeRays thin(const Keyframe& keyframe, std::optional<double> body_height_m);

 private:
  // True if no ray from this group of viewpoints ended here yet.
  bool isNew(int group, const Eigen::Vector3f& end, bool coarse);

  float cell_m_;
  float max_range_m_;
  int half_;  // of the square of cells around the body
  // Per group of viewpoints and column, the heights at which a ray ended: scratch, zero between calls.
  std::vector<std::vector<uint32_t>> ends_;
};

}  // namespace sgraphs
