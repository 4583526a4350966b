#pragma once

#include <memory>
#include <optional>

#include "common/types/keyframe.h"
#include "common/types/loops.h"
#include "common/types/map_update.h"
#include "perception/loops/loops_config.h"

namespace sgraphs {

// Finds where the robot has come back to. A pure function of its inputs so far.
class LoopFinder {
 public:
  explicit LoopFinder(const LoopsConfig& config);
  ~LoopFinder();

  // The keyframe that the round brought, if it did and its cloud came, and what the round changed of the map.
  LoopClosures step(const std::optional<Keyframe>& keyframe, const MapUpdate& update);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sgraphs
