#include "perception/planes/planes_node.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "common/bus/status.h"

namespace sgraphs {
PlanesNode::PlanesNode(Bus& bus, Step step) : bus_(bus), publisher_(bus), step_(std::move(step)) {
  subscribe(
      bus_, channels::kSession, [this](const session_t& m) { onSession(m); },
      [this] { gate_.reject(channels::kSession.name, "undecodable"); });
  listen(channels::kKeyframe, &PlanesNode::onKeyframe);
  listen(channels::kStreamEnd, &PlanesNode::onStreamEnd);
  listen(channels::kOdometryEnd, &PlanesNode::onOdometryEnd);
}

template <typename Message>
void PlanesNode::listen(const Channel<Message>& channel, void (PlanesNode::*handler)(const Message&)) {
  early_.listen(bus_, gate_, channel, [this, handler](const Message& m) { (this->*handler)(m); });
}

void PlanesNode::onSession(const session_t& m) {
  const std::string channel = channels::kSession.name;
  if (done()) return;
  const std::optional<Session> session = fromMessage(m);
  if (!session)
    return gate_.reject(channel, "no session id, another schema, or content that cannot be right");
  if (!gate_.accept(channel, m.header) || session_) return;
  session_ = session;
  newest_time_ = session->start;
  publisher_.setSession(session->id);
  const auto& stages = session->stages;
  takes_part_ = stages.empty() || std::find(stages.begin(), stages.end(), "planes") != stages.end();
  early_.open();
}

void PlanesNode::onKeyframe(const keyframe_t& m) {
  const std::string channel = channels::kKeyframe.name;
  int64_t lost_before = 0;
  if (done() || !gate_.accept(channel, m.header, &lost_before) || !takes_part_) return;
  if (m.keyframe < next_) return gate_.reject(channel, "its planes are published");
  // Each keyframe between has lost a message at least.
  if (m.keyframe > announced_ && m.keyframe - announced_ - 1 > lost_before)
    return gate_.reject(channel, "a keyframe that cannot be");
  const KeyframeAssembly::Fate fate = assembly_.add(m);
  if (fate == KeyframeAssembly::Fate::kRefused) return gate_.reject(channel, "counts that do not match");
  announced_ = std::max(announced_, m.keyframe);
  workOffBefore(announced_);
  if (fate == KeyframeAssembly::Fate::kComplete && m.keyframe == announced_) segment(m.keyframe);
}

void PlanesNode::workOffBefore(int64_t keyframe) {
  for (int64_t held = 0; (held = assembly_.firstFrom(next_)) >= 0 && held < keyframe;) segment(held);
}

void PlanesNode::segment(int64_t id) {
  next_ = id + 1;
  KeyframePlanes planes{KeyframeId{id}, newest_time_, {}};
  if (const std::optional<Keyframe> keyframe = assembly_.take(id)) {
    newest_time_ = std::max(newest_time_, keyframe->time);
    const Stopwatch watch;
    planes = step_(*keyframe);
    latency_.add(watch.elapsedUs());
  } else {
    gate_.reject(channels::kKeyframe.name, "content that cannot be right");
  }
  keyframe_planes_t message = toMessage(planes);
  publisher_.send(channels::kKeyframePlanes, message);
}

void PlanesNode::onStreamEnd(const stream_end_t& m) {
  if (done() || !gate_.accept(channels::kStreamEnd.name, m.header)) return;
  closeChannel(gate_, m, channels::kSession.name);
  stream_ended_ = true;
}

void PlanesNode::onOdometryEnd(const stream_end_t& m) {
  if (done() || !gate_.accept(channels::kOdometryEnd.name, m.header)) return;
  closeChannel(gate_, m, channels::kKeyframe.name);
  newest_time_ = std::max(newest_time_, Time{m.header.utime});
  finish(m.why_not);
}

void PlanesNode::finish(const std::string& why_not) {
  if (done()) return;
  workOffBefore(std::numeric_limits<int64_t>::max());
  stream_end_t end{};
  end.header.utime = newest_time_.us;
  end.why_not = gate_.trouble();
  if (!why_not.empty()) end.why_not += (end.why_not.empty() ? "" : "; ") + why_not;
  publisher_.addTo(end, channels::kKeyframePlanes.name);
  publisher_.send(channels::kPlanesEnd, end);
  end_ = std::move(end);
}

void PlanesNode::repeatEnd() {
  if (end_) publish(bus_, channels::kPlanesEnd, *end_);
}

void PlanesNode::publishStatus() {
  const std::string state = done()        ? "done"
                            : !session_   ? "waiting for SESSION"
                            : takes_part_ ? "running"
                                          : "not a stage of this SESSION";
  status_t status = makeStatus("sgraphs-planes", state, gate_, publisher_, assembly_.size(), latency_);
  status.header.utime = newest_time_.us;
  publisher_.send(channels::kStatusPlanes, status);
}

}  // namespace sgraphs
