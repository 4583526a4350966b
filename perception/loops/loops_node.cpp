#include "perception/loops/loops_node.h"

#include <utility>

#include "lcmtypes/convert/convert_layers.h"

namespace sgraphs {

LoopsNode::LoopsNode(Bus& bus, Step step)
    : io_(bus, "loops", "sgraphs-loops"),
      step_(std::move(step)),
      follower_(io_, [this](const auto& keyframe, const auto& update) { work(keyframe, update); }) {}

void LoopsNode::work(const std::optional<Keyframe>& keyframe, const MapUpdate& update) {
  const Stopwatch watch;
  const LoopClosures loops = step_(keyframe, update);
  latency_.add(watch.elapsedUs());
  for (loop_closures_t& m : toMessages(loops, io_.gate().trouble())) io_.send(channels::kLoopClosures, m);
}

void LoopsNode::publishStatus() {
  io_.publishStatus(channels::kStatusLoops, follower_.newestTime(), follower_.queueDepth(), latency_);
}

}  // namespace sgraphs
