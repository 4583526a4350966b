#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/base/performance.h"
#include "common/types/plane.h"
#include "lcmtypes/convert/keyframe_assembly.h"
#include "perception/stage/stage_io.h"

namespace sgraphs {

// Plane segmentation on a bus: SESSION, KEYFRAME, STREAM_END, ODOMETRY_END in; KEYFRAME_PLANES, PLANES_END
// out. One KEYFRAME_PLANES per keyframe of which anything came, in order of keyframes. One that lost chunks
// is worked off from what came as soon as a later one or the end is heard; one whose content cannot be right
// has no planes. If SESSION does not list the stage "planes", only the end is published.
class PlanesNode {
 public:
  using Step = std::function<KeyframePlanes(const Keyframe&)>;

  // The bus must outlive the node.
  PlanesNode(Bus& bus, Step step);

  // Ends a run whose ODOMETRY_END does not come: works off what is held and publishes PLANES_END. `why_not`:
  // why another run may differ; empty if it may not.
  void finish(const std::string& why_not);
  void publishStatus();
  // Sends PLANES_END once more, for a reader that lost it (same sequence number).
  void repeatEnd();

  bool done() const { return end_.has_value(); }
  // STREAM_END was heard: ODOMETRY_END should follow soon.
  bool streamEnded() const { return stream_ended_; }
  // Why this run is not reproducible; empty if it is. Known once done.
  std::string whyNot() const { return end_ ? end_->why_not : ""; }

  const InputGate& gate() const { return io_.gate(); }
  const LatencyHistogram& stepLatency() const { return latency_; }

 private:
  void onKeyframe(const keyframe_t& m);
  void onStreamEnd(const stream_end_t& m);
  void onOdometryEnd(const stream_end_t& m);
  void workOffBefore(int64_t keyframe);
  void segment(int64_t keyframe);

  Bus& bus_;
  StageIo io_;
  Step step_;
  KeyframeAssembly assembly_;

  int64_t next_ = 0;        // keyframe
  int64_t announced_ = -1;  // newest keyframe heard of
  Time newest_time_;
  bool stream_ended_ = false;
  std::optional<stream_end_t> end_;
  LatencyHistogram latency_;
};

}  // namespace sgraphs
