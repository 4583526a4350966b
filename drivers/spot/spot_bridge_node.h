#pragma once

#include <functional>
#include <optional>

#include "common/bus/bus.h"
#include "common/bus/channels.h"
#include "common/bus/input_gate.h"
#include "common/bus/publisher.h"
#include "common/types/session.h"
#include "drivers/spot/spot_bridge.h"

namespace sgraphs {

// The bridge on a bus: SPOT_ODOMETRY for the SESSION that it hears, or for one of its own, and
// STATUS_SPOT_BRIDGE.
class SpotBridgeNode {
 public:
  // `own`: the session to publish at 1 Hz; nothing: waits for one. `boot` is raised by one with each restart
  // within a session. `host_clock`: microseconds since the epoch, for the stamps of SESSION. Bus and bridge
  // must outlive this.
  SpotBridgeNode(Bus& bus, SpotBridge& bridge, const std::optional<Session>& own, int64_t boot,
                 std::function<Time()> host_clock);

  // Does what is due; publishes a sample if there is one. Throws Error if the bridge does, and if another
  // source publishes a SESSION beside an own one.
  void step();

  // Called once a second: STATUS_SPOT_BRIDGE, and the own SESSION.
  void everySecond();

  // Ends an own session: STREAM_END, three times, since a datagram may be lost.
  void finish();

  // STREAM_END of the session was heard.
  bool done() const { return done_; }

 private:
  void onSession(const session_t& m);
  void onStreamEnd(const stream_end_t& m);
  void publishSession();
  void publishStatus();

  Bus& bus_;
  SpotBridge& bridge_;
  std::function<Time()> host_clock_;
  Publisher publisher_;
  InputGate gate_;
  std::optional<Session> session_;
  bool own_ = false;
  bool done_ = false;
  Time newest_;
};

}  // namespace sgraphs
