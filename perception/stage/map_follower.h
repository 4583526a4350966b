#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <set>

#include "common/types/keyframe.h"
#include "common/types/map_update.h"
#include "lcmtypes/convert/keyframe_assembly.h"
#include "perception/stage/map_update_input.h"
#include "perception/stage/stage_io.h"

namespace sgraphs {

// What the stages do alike that follow the backend's map with the keyframes' clouds: KEYFRAME, GRAPH_UPDATE,
// ODOMETRY_END, STREAM_END, RUN_RESULT in; one call per GRAPH_UPDATE, in order of rounds. A round whose
// keyframe was lost goes on without its cloud.
class MapFollower {
 public:
  // The keyframe that the round brought, if it did and its message came, and what the round changed.
  using Work = std::function<void(const std::optional<Keyframe>&, const MapUpdate&)>;

  // `io` must outlive this, and has nothing else to listen to these channels.
  MapFollower(StageIo& io, Work work);

  bool streamEnded() const { return stream_ended_; }
  Time newestTime() const { return newest_time_; }
  size_t queueDepth() const { return updates_.size() + assembly_.size(); }

 private:
  void onKeyframe(const keyframe_t& m);
  void onGraphUpdate(const graph_update_t& m);
  void advance();
  bool cloudAwaited(KeyframeId keyframe) const;
  void workOn(const MapUpdate& update);

  StageIo& io_;
  Work work_;
  KeyframeAssembly assembly_;
  MapUpdateInput map_updates_{io_};
  std::set<int64_t> complete_;  // keyframes whose chunks have all come
  int64_t announced_ = -1;      // newest keyframe heard of
  bool keyframes_ended_ = false;
  std::deque<MapUpdate> updates_;  // not yet worked on
  KeyframeId worked_;              // newest keyframe worked on
  Time newest_time_;
  bool stream_ended_ = false;
};

}  // namespace sgraphs
