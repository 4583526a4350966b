#pragma once

#include <deque>
#include <optional>

#include "common/types/keyframe.h"

namespace sgraphs {

// How high the body stands over the walking surface. Legs hold the body at one height: where no floor is in
// view (a small room, a crowd) what was seen before still holds.
class SurfaceHeight {
 public:
  // Height of the body's origin over the surface [m] at this keyframe, T_map_body for want of a better
  // vertical; nothing until a floor has been seen.
  std::optional<double> step(const Keyframe& keyframe, const SE3& T_map_body);

  // The dominant low level of the keyframe's own cloud, as height of the body over it.
  static std::optional<double> measure(const Keyframe& keyframe, const Eigen::Vector3d& up_body);

 private:
  double median() const;

  std::deque<double> recent_m_;
};

}  // namespace sgraphs
