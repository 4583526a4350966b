#pragma once

#include <optional>
#include <string>

#include "common/base/performance.h"
#include "common/bus/bus.h"
#include "common/bus/channels.h"
#include "common/bus/input_gate.h"
#include "common/bus/publisher.h"
#include "common/types/session.h"
#include "drivers/driver_config.h"
#include "drivers/velodyne_live/datagram_source.h"
#include "drivers/velodyne_live/live_packets.h"

namespace sgraphs {

// The VLP-16's driver on a bus: datagrams in; VELODYNE_PACKETS, STATUS_VELODYNE_DRIVER and, if it is the
// session's source, SESSION and STREAM_END out. Without a session of its own it waits for SESSION from the
// bus; what the sensor sends before is counted and not published.
class VelodyneDriverNode {
 public:
  // session: nothing to wait for SESSION. The bus must outlive the node.
  VelodyneDriverNode(Bus& bus, LivePackets packets, const VelodyneDriverConfig& config,
                     std::optional<Session> session);

  void take(const UdpDatagram& datagram);

  // To be called about once a second: SESSION and STATUS. elapsed_s: since the last call; now: the source's
  // clock.
  void everySecond(double elapsed_s, Time now, const DatagramSource::Health& health);

  // Publishes what waits, and, if asked for, STREAM_END. `why_not` as in stream_end_t.
  void finish(bool stream_end, const std::string& why_not);
  // Sends STREAM_END once more, for a reader that lost it (same sequence number).
  void repeatEnd();

  const LivePackets& packets() const { return packets_; }
  bool silent() const { return quiet_s_ >= config_.silence_s; }
  // Lines for people since the last call.
  std::vector<std::string> takeNotices();

 private:
  void onSession(const session_t& m);
  void publishSession(Time now);
  void publishGroup(const PacketGroup& group);
  void publishStatus(Time now, const DatagramSource::Health& health);
  std::string state() const;

  Bus& bus_;
  LivePackets packets_;
  VelodyneDriverConfig config_;
  std::optional<Session> session_;
  const bool own_session_;
  Publisher publisher_;
  InputGate gate_;
  Notices notices_;
  LatencyHistogram latency_;
  std::optional<Time> newest_;   // published packet
  int64_t before_session_ = 0;   // packets
  int64_t counted_packets_ = 0;  // accepted up to the last call of everySecond
  double rate_hz_ = 0, quiet_s_ = 0;
  int64_t dropped_ = 0;
  std::optional<stream_end_t> end_;
};

}  // namespace sgraphs
