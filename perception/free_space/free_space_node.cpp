#include "perception/free_space/free_space_node.h"

#include <utility>

#include "lcmtypes/convert/convert_layers.h"

namespace sgraphs {

FreeSpaceNode::FreeSpaceNode(Bus& bus, Step step)
    : io_(bus, "free-space", "sgraphs-free-space"),
      step_(std::move(step)),
      follower_(io_, [this](const auto& keyframe, const auto& update) { work(keyframe, update); }) {}

void FreeSpaceNode::work(const std::optional<Keyframe>& keyframe, const MapUpdate& update) {
  const Stopwatch watch;
  const FreeSpace& now = step_(keyframe, update);
  latency_.add(watch.elapsedUs());
  for (free_space_t& m : toMessages(published_, now, io_.gate().trouble())) io_.send(channels::kFreeSpace, m);
  published_ = now;
}

void FreeSpaceNode::publishStatus() {
  io_.publishStatus(channels::kStatusFreeSpace, follower_.newestTime(), follower_.queueDepth(), latency_);
}

}  // namespace sgraphs
