#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <set>
#include <string>

#include "common/base/performance.h"
#include "common/types/free_space.h"
#include "common/types/keyframe.h"
#include "common/types/map_update.h"
#include "lcmtypes/convert/chunks.h"
#include "lcmtypes/convert/keyframe_assembly.h"
#include "perception/stage/stage_io.h"

namespace sgraphs {

// Free space on a bus: SESSION, KEYFRAME, GRAPH_UPDATE, ODOMETRY_END, STREAM_END, RUN_RESULT in; FREE_SPACE
// out. One FREE_SPACE per GRAPH_UPDATE, in order of rounds; a round whose keyframe was lost goes on without
// its cloud. If SESSION does not list the stage "free-space", nothing is said.
class FreeSpaceNode {
 public:
  // The keyframe that the round brought, if it did and its message came, and what the round changed. The
  // result stays valid until the next call.
  using Step = std::function<const FreeSpace&(const std::optional<Keyframe>&, const MapUpdate&)>;

  // The bus must outlive the node.
  FreeSpaceNode(Bus& bus, Step step);

  void publishStatus();
  // Ends a run whose RUN_RESULT does not come.
  void finish() { io_.close(); }
  bool done() const { return io_.closed(); }
  bool streamEnded() const { return stream_ended_; }

  const InputGate& gate() const { return io_.gate(); }
  const LatencyHistogram& stepLatency() const { return latency_; }

 private:
  void onKeyframe(const keyframe_t& m);
  void onGraphUpdate(const graph_update_t& m);
  void advance();
  bool cloudAwaited(KeyframeId keyframe) const;
  void work(const MapUpdate& update);

  StageIo io_;
  Step step_;
  KeyframeAssembly assembly_;
  RoundAssembly<graph_update_t> updates_assembly_;
  std::set<int64_t> complete_;  // keyframes whose chunks have all come
  int64_t announced_ = -1;      // newest keyframe heard of
  bool keyframes_ended_ = false;
  std::deque<MapUpdate> updates_;  // not yet worked on
  KeyframeId worked_;              // newest keyframe worked on
  FreeSpace published_;
  Time newest_time_;
  bool stream_ended_ = false;
  LatencyHistogram latency_;
};

}  // namespace sgraphs
