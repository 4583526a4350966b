#pragma once

#include <map>
#include <optional>

#include "common/types/keyframe.h"

namespace sgraphs {

// Each keyframe's one measurement from an earlier keyframe: what the way from one to another was without
// walls and loops, and how well that is known. Independent of the state of the map.
class OdometryChain {
 public:
  // z.to is a new keyframe, z.from one before it.
  void add(const RelativePose& z) { from_.emplace(z.to, z); }

  // Composed from the one to the other (kind odometry); none if a keyframe on the way is not known. Legs err
  // by bias, not by chance: the covariance is that of steps that all err alike.
  std::optional<RelativePose> between(KeyframeId from, KeyframeId to) const;

 private:
  std::map<KeyframeId, RelativePose> from_;  // by z.to
};

}  // namespace sgraphs
