#include "drivers/velodyne_live/velodyne_driver_node.h"

#include <algorithm>
#include <cstdio>
#include <utility>

#include "common/bus/channels.h"
#include "common/bus/status.h"
#include "lcmtypes/convert/convert.h"

namespace sgraphs {
namespace {

std::string fixed(double value, int decimals) {
  char text[32];
  std::snprintf(text, sizeof text, "%.*f", decimals, value);
  return text;
}

// A row of STATUS about something that is no channel.
void addRow(status_t& status, const std::string& name, int64_t count, int64_t lost, int64_t rejected) {
  status.channel.push_back(name);
  status.count.push_back(count);
  status.lost.push_back(lost);
  status.rejected.push_back(rejected);
  status.last_seq.push_back(-1);
  status.num_channels = static_cast<int32_t>(status.channel.size());
}

}  // namespace

VelodyneDriverNode::VelodyneDriverNode(Bus& bus, LivePackets packets, const VelodyneDriverConfig& config,
                                       std::optional<Session> session)
    : bus_(bus),
      packets_(std::move(packets)),
      config_(config),
      session_(std::move(session)),
      own_session_(session_.has_value()),
      publisher_(bus) {
  if (session_) {
    publisher_.setSession(session_->id);
    publishSession(session_->start);
    return;
  }
  subscribe(
      bus_, channels::kSession, [this](const session_t& m) { onSession(m); },
      [this] { gate_.reject(channels::kSession.name, "undecodable"); });
}

void VelodyneDriverNode::onSession(const session_t& m) {
  const std::optional<Session> session = fromMessage(m);
  if (!session)
    return gate_.reject(channels::kSession.name,
                        "no session id, another schema, or content that cannot be right");
  if (!gate_.acceptSession(channels::kSession.name, session->id) || session_) return;
  session_ = session;
  publisher_.setSession(session->id);
}

void VelodyneDriverNode::publishSession(Time now) {
  session_t message = toMessage(*session_, now);
  publisher_.send(channels::kSession, message);
}

void VelodyneDriverNode::take(const UdpDatagram& datagram) {
  const Stopwatch watch;
  const std::optional<PacketGroup> group = packets_.step(datagram);
  latency_.add(watch.elapsedUs());
  if (group) publishGroup(*group);
}

void VelodyneDriverNode::publishGroup(const PacketGroup& group) {
  newest_ = group.packets.back().time;
  if (!session_) {
    before_session_ += static_cast<int64_t>(group.packets.size());
    return;
  }
  velodyne_packets_t message = toMessage(group.packets, group.revolution, group.part, group.last_part);
  publisher_.send(channels::kVelodynePackets, message);
}

void VelodyneDriverNode::everySecond(double elapsed_s, Time now, const DatagramSource::Health& health) {
  const int64_t fresh =
      packets_.counts().accepted - std::exchange(counted_packets_, packets_.counts().accepted);
  rate_hz_ = elapsed_s > 0 ? static_cast<double>(fresh) / elapsed_s : 0.0;
  const bool was_silent = silent();
  quiet_s_ = fresh > 0 ? 0.0 : quiet_s_ + elapsed_s;
  if (silent() && !was_silent)
    notices_.add("silence", "no LiDAR packet for " + fixed(quiet_s_, 1) + " s on UDP port " +
                                std::to_string(config_.data_port) +
                                ": is the sensor on, and does it send to this machine?");
  if (was_silent && !silent()) notices_.add("back", "LiDAR packets arrive");
  const int64_t dropped = health.dropped_by_kernel + health.dropped_by_queue;
  if (dropped > dropped_)
    notices_.add("dropped", std::to_string(dropped - dropped_) +
                                " packet(s) dropped by this machine: raise net.core.rmem_max, or relieve it");
  dropped_ = dropped;
  if (own_session_) publishSession(now);
  publishStatus(now, health);
}

std::string VelodyneDriverNode::state() const {
  if (end_) return "done";
  if (!session_) return "waiting for SESSION";
  if (silent())
    return "silent: no LiDAR for " + fixed(quiet_s_, 1) + " s" +
           (packets_.thirtyTwoBeams() ? ", the sensor has 32 beams and is refused" : "");
  std::string text = "running: " + fixed(rate_hz_, 1) + " packets/s, stamps " + config_.stamps;
  if (const auto& position = packets_.position())
    text += std::string(", GPS pulse ") + toString(position->pps) + (position->fix ? ", fix" : ", no fix");
  return text;
}

void VelodyneDriverNode::publishStatus(Time now, const DatagramSource::Health& health) {
  status_t status =
      makeStatus("sgraphs-velodyne-driver", state(), gate_, publisher_, health.waiting, latency_);
  const PacketCounts& counts = packets_.counts();
  int64_t refused = 0;
  for (const int64_t count : counts.rejected) refused += count;
  addRow(status, "udp data", counts.accepted, counts.lost, refused);
  addRow(status, "udp position", counts.position, 0, counts.other_datagrams);
  for (int fault = 1; fault < kNumPacketFaults; ++fault)
    if (const int64_t count = counts.rejected[static_cast<size_t>(fault)]; count > 0)
      addRow(status, std::string("refused: ") + toString(static_cast<PacketFault>(fault)), 0, 0, count);
  if (counts.other_sensor > 0) addRow(status, "refused: second sensor", 0, 0, counts.other_sensor);
  if (before_session_ > 0) addRow(status, "refused: before SESSION", 0, 0, before_session_);
  addRow(status, "dropped by the kernel", 0, health.dropped_by_kernel, 0);
  addRow(status, "dropped by the driver's queue", 0, health.dropped_by_queue, 0);
  status.header.utime = newest_.value_or(now).us;
  publisher_.send(channels::kStatusVelodyneDriver, status);
}

void VelodyneDriverNode::finish(bool stream_end, const std::string& why_not) {
  if (end_) return;
  if (const auto group = packets_.flush()) publishGroup(*group);
  if (!stream_end || !session_) return;
  stream_end_t end{};
  end.why_not = why_not;
  end.header.utime = newest_.value_or(session_->start).us;
  if (own_session_) publisher_.addTo(end, channels::kSession.name);
  publisher_.addTo(end, channels::kVelodynePackets.name);
  publisher_.send(channels::kStreamEnd, end);
  end_ = std::move(end);
}

void VelodyneDriverNode::repeatEnd() {
  if (end_) publish(bus_, channels::kStreamEnd, *end_);
}

std::vector<std::string> VelodyneDriverNode::takeNotices() {
  std::vector<std::string> lines = packets_.takeNotices();
  for (std::string& line : notices_.take()) lines.push_back(std::move(line));
  return lines;
}

}  // namespace sgraphs
