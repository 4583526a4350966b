#include "perception/loops/loop_finder.h"

namespace sgraphs {

class LoopFinder::Impl {};

LoopFinder::LoopFinder(const LoopsConfig&) : impl_(std::make_unique<Impl>()) {}
LoopFinder::~LoopFinder() = default;

LoopClosures LoopFinder::step(const std::optional<Keyframe>&, const MapUpdate& update) {
  LoopClosures none;
  none.round = update.round;
  none.time = update.time;
  return none;
}

}  // namespace sgraphs
