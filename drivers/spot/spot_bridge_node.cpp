#include "drivers/spot/spot_bridge_node.h"

#include <spdlog/spdlog.h>

#include <utility>

#include "common/base/error.h"
#include "common/bus/status.h"
#include "lcmtypes/convert/convert.h"

namespace sgraphs {
namespace {

void addRow(status_t& status, const std::string& name, const CallCount& count) {
  status.channel.push_back(name);
  status.count.push_back(count.answered);
  status.lost.push_back(count.failed);
  status.rejected.push_back(count.refused);
  status.last_seq.push_back(-1);
  status.num_channels = static_cast<int32_t>(status.channel.size());
}

}  // namespace

SpotBridgeNode::SpotBridgeNode(Bus& bus, SpotBridge& bridge, const std::optional<Session>& own, int64_t boot,
                               std::function<Time()> host_clock)
    : bus_(bus),
      bridge_(bridge),
      host_clock_(std::move(host_clock)),
      publisher_(bus, boot),
      session_(own),
      own_(own.has_value()) {
  subscribe(
      bus_, channels::kSession, [this](const session_t& m) { onSession(m); },
      [this] { gate_.reject(channels::kSession.name, "undecodable"); });
  subscribe(
      bus_, channels::kStreamEnd, [this](const stream_end_t& m) { onStreamEnd(m); },
      [this] { gate_.reject(channels::kStreamEnd.name, "undecodable"); });
  if (!own_) return;
  publisher_.setSession(own->id);
  publishSession();
}

void SpotBridgeNode::onSession(const session_t& m) {
  if (own_) {
    if (m.header.session == session_->id) return;  // a bus brings back what one says
    throw Error("'" + m.writer +
                "' publishes a SESSION, too: leave out --session, so that this bridge joins it");
  }
  const std::string channel = channels::kSession.name;
  const std::optional<Session> session = fromMessage(m);
  if (!session)
    return gate_.reject(channel, "no session id, another schema, or content that cannot be right");
  if (!gate_.acceptSession(channel, session->id) || session_) return;
  session_ = session;
  publisher_.setSession(session->id);
  if (!session->has_odometry)
    spdlog::warn("SESSION of '{}' says that it carries no odometry: what the bridge sends may not be used",
                 session->writer);
}

void SpotBridgeNode::onStreamEnd(const stream_end_t& m) {
  if (own_ || !session_) return;
  if (m.header.session != session_->id) return gate_.reject(channels::kStreamEnd.name, "of another session");
  done_ = true;
}

void SpotBridgeNode::step() {
  if (done_) return;
  const std::optional<BodyOdometry> sample = bridge_.step(session_.has_value());
  if (!sample) return;
  newest_ = sample->time;
  spot_odometry_t message = toMessage(*sample);
  publisher_.send(channels::kSpotOdometry, message);
  if (sample->twist_body)
    publisher_.sendPlain(channels::kPoseSpot,
                         toPoseMessage(sample->time, sample->T_odom_body, *sample->twist_body));
}

void SpotBridgeNode::everySecond() {
  if (own_) publishSession();
  publishStatus();
}

void SpotBridgeNode::publishSession() {
  session_t message = toMessage(*session_, host_clock_());
  publisher_.send(channels::kSession, message);
}

void SpotBridgeNode::publishStatus() {
  std::string state = done_ ? "done" : bridge_.state();
  if (!session_) state = "waiting for SESSION; " + state;
  status_t status = makeStatus("sgraphs-spot-bridge", state, gate_, publisher_, 0, bridge_.latency());
  for (const auto& [call, count] : bridge_.counts()) addRow(status, call, count);
  addRow(status, "robot-state, repeated", {bridge_.repeated(), 0, 0});
  status.header.utime = newest_.us;
  publisher_.send(channels::kStatusSpotBridge, status);
}

void SpotBridgeNode::finish() {
  if (own_) {
    stream_end_t end{};
    end.header.utime = newest_.us;
    publisher_.addTo(end, channels::kSession.name);
    publisher_.addTo(end, channels::kSpotOdometry.name);
    publisher_.send(channels::kStreamEnd, end);
    for (int i = 0; i < 2; ++i) publish(bus_, channels::kStreamEnd, end);
  }
  done_ = true;
  publishStatus();
}

}  // namespace sgraphs
