#pragma once

#include <functional>
#include <optional>
#include <string>

#include "common/base/performance.h"
#include "common/bus/bus.h"
#include "common/bus/input_gate.h"
#include "lcmtypes/convert/keyframe_assembly.h"
#include "perception/relocalise/relocaliser.h"
#include "perception/relocalise/session_joiner.h"

namespace sgraphs {

// Between a session's bus, on which its odometry and planes speak, and the map's: KEYFRAME, KEYFRAME_PLANES,
// ODOMETRY, ODOMETRY_END, PLANES_END in; the same out, once the robot is found, as the map's continuation.
class RelocaliseNode {
 public:
  using Step = std::function<std::optional<Relocalisation>(const Keyframe&)>;

  // Both buses must outlive the node. What it says on `map` is delivered at once. `step` is called until it
  // finds the robot, or `lost` (asked after each step) gives it up.
  RelocaliseNode(Bus& session, Bus& map, const MapEnd& map_end, Step step, std::function<bool()> lost);

  struct Found {
    Relocalisation at;
    Duration after;  // sensor time from the session's first keyframe to the look that found it
  };
  const std::optional<Found>& found() const { return found_; }
  // The session had a keyframe.
  bool heard() const { return first_.has_value(); }
  const SessionJoiner& joiner() const { return joiner_; }
  const LatencyHistogram& stepLatency() const { return latency_; }
  const InputGate& gate() const { return gate_; }

 private:
  template <typename Message, typename Handler>
  void listen(Bus& session, const Channel<Message>& channel, Handler handler);
  template <typename Message>
  void say(const Channel<Message>& channel, const Message& m);
  SessionJoiner::Sink sink();
  void onKeyframe(const keyframe_t& m);

  Bus& map_;
  Step step_;
  std::function<bool()> lost_;
  SessionJoiner joiner_;
  KeyframeAssembly assembly_;
  InputGate gate_;
  std::optional<Found> found_;
  std::optional<Time> first_;
  bool given_up_ = false;  // nothing is looked for or kept any more
  LatencyHistogram latency_;
};

}  // namespace sgraphs
