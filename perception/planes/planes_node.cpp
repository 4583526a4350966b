#include "perception/planes/planes_node.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace sgraphs {

PlanesNode::PlanesNode(Bus& bus, Step step)
    : bus_(bus), io_(bus, "planes", "sgraphs-planes"), step_(std::move(step)) {
  io_.listen(channels::kKeyframe, [this](const keyframe_t& m) { onKeyframe(m); });
  io_.listen(channels::kStreamEnd, [this](const stream_end_t& m) { onStreamEnd(m); });
  io_.listen(channels::kOdometryEnd, [this](const stream_end_t& m) { onOdometryEnd(m); });
}

void PlanesNode::onKeyframe(const keyframe_t& m) {
  int64_t lost_before = 0;
  if (!io_.accept(channels::kKeyframe, m, &lost_before) || !io_.takesPart()) return;
  if (m.keyframe < next_) return io_.reject(channels::kKeyframe, "its planes are published");
  // Each keyframe between has lost a message at least.
  if (m.keyframe > announced_ && m.keyframe - announced_ - 1 > lost_before)
    return io_.reject(channels::kKeyframe, "a keyframe that cannot be");
  const KeyframeAssembly::Fate fate = assembly_.add(m);
  if (fate == KeyframeAssembly::Fate::kRefused)
    return io_.reject(channels::kKeyframe, "counts that do not match");
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
    io_.reject(channels::kKeyframe, "content that cannot be right");
  }
  keyframe_planes_t message = toMessage(planes);
  io_.send(channels::kKeyframePlanes, message);
}

void PlanesNode::onStreamEnd(const stream_end_t& m) {
  if (!io_.accept(channels::kStreamEnd, m)) return;
  closeChannel(io_.gate(), m, channels::kSession.name);
  stream_ended_ = true;
}

void PlanesNode::onOdometryEnd(const stream_end_t& m) {
  if (!io_.accept(channels::kOdometryEnd, m)) return;
  closeChannel(io_.gate(), m, channels::kKeyframe.name);
  newest_time_ = std::max(newest_time_, Time{m.header.utime});
  finish(m.why_not);
}

void PlanesNode::finish(const std::string& why_not) {
  if (done()) return;
  workOffBefore(std::numeric_limits<int64_t>::max());
  if (io_.session()) newest_time_ = std::max(newest_time_, io_.session()->start);
  stream_end_t end{};
  end.header.utime = newest_time_.us;
  end.why_not = io_.gate().trouble();
  if (!why_not.empty()) end.why_not += (end.why_not.empty() ? "" : "; ") + why_not;
  io_.publisher().addTo(end, channels::kKeyframePlanes.name);
  io_.send(channels::kPlanesEnd, end);
  end_ = std::move(end);
  io_.close();
}

void PlanesNode::repeatEnd() {
  if (end_) publish(bus_, channels::kPlanesEnd, *end_);
}

void PlanesNode::publishStatus() {
  io_.publishStatus(channels::kStatusPlanes, newest_time_, assembly_.size(), latency_);
}

}  // namespace sgraphs
