#pragma once

#include <functional>
#include <optional>

#include "common/base/performance.h"
#include "common/types/keyframe.h"
#include "common/types/loops.h"
#include "common/types/map_update.h"
#include "perception/stage/map_follower.h"
#include "perception/stage/stage_io.h"

namespace sgraphs {

// Loops on a bus: SESSION, KEYFRAME, GRAPH_UPDATE, ODOMETRY_END, STREAM_END, RUN_RESULT in; LOOP_CLOSURES
// out, one per GRAPH_UPDATE, in order of rounds. If SESSION does not list the stage "loops", nothing is said.
class LoopsNode {
 public:
  // The keyframe that the round brought, if it did and its message came, and what the round changed.
  using Step = std::function<LoopClosures(const std::optional<Keyframe>&, const MapUpdate&)>;

  // The bus must outlive the node.
  LoopsNode(Bus& bus, Step step);

  void publishStatus();
  // Ends a run whose RUN_RESULT does not come.
  void finish() { io_.close(); }
  bool done() const { return io_.closed(); }
  bool streamEnded() const { return follower_.streamEnded(); }

  const InputGate& gate() const { return io_.gate(); }
  const LatencyHistogram& stepLatency() const { return latency_; }

 private:
  void work(const std::optional<Keyframe>& keyframe, const MapUpdate& update);

  StageIo io_;
  Step step_;
  MapFollower follower_;
  LatencyHistogram latency_;
};

}  // namespace sgraphs
