#include "perception/relocalise/relocalise_node.h"

#include <utility>

#include "common/bus/channels.h"

namespace sgraphs {

RelocaliseNode::RelocaliseNode(Bus& session, Bus& map, const MapEnd& map_end, Step step,
                               std::function<bool()> lost)
    : map_(map), step_(std::move(step)), lost_(std::move(lost)), joiner_(map_end, sink()) {
  listen(session, channels::kKeyframe, [this](const keyframe_t& m) { onKeyframe(m); });
  listen(session, channels::kKeyframePlanes, [this](const keyframe_planes_t& m) { joiner_.add(m); });
  listen(session, channels::kOdometry, [this](const odometry_t& m) { joiner_.add(m); });
  listen(session, channels::kOdometryEnd, [this](const stream_end_t& m) { joiner_.addOdometryEnd(m); });
  listen(session, channels::kPlanesEnd, [this](const stream_end_t& m) { joiner_.addPlanesEnd(m); });
}

template <typename Message, typename Handler>
void RelocaliseNode::listen(Bus& session, const Channel<Message>& channel, Handler handler) {
  const std::string name = channel.name;
  subscribe(
      session, channel,
      [this, name, handler](const Message& m) {
        if (!given_up_ && gate_.accept(name, m.header)) handler(m);
      },
      [this, name] { gate_.reject(name, "undecodable"); });
}

template <typename Message>
void RelocaliseNode::say(const Channel<Message>& channel, const Message& m) {
  publish(map_, channel, m);
  map_.dispatch(0);
}

SessionJoiner::Sink RelocaliseNode::sink() {
  return {[this](const odometry_t& m) { say(channels::kOdometry, m); },
          [this](const keyframe_t& m) { say(channels::kKeyframe, m); },
          [this](const keyframe_planes_t& m) { say(channels::kKeyframePlanes, m); },
          [this](const stream_end_t& m) { say(channels::kOdometryEnd, m); },
          [this](const stream_end_t& m) { say(channels::kPlanesEnd, m); }};
}

void RelocaliseNode::onKeyframe(const keyframe_t& m) {
  joiner_.add(m);
  if (found_) return;
  if (assembly_.add(m) != KeyframeAssembly::Fate::kComplete) return;
  const std::optional<Keyframe> keyframe = assembly_.take(m.keyframe);
  if (!keyframe) return gate_.reject(channels::kKeyframe.name, "content that cannot be right");
  if (!first_) first_ = keyframe->time;
  const Stopwatch watch;
  const std::optional<Relocalisation> at = step_(*keyframe);
  latency_.add(watch.elapsedUs());
  if (!at) {
    if (!lost_()) return;
    given_up_ = true;
    return joiner_.drop();
  }
  step_ = {};  // and the places of the map with it
  lost_ = {};
  found_ = Found{*at, keyframe->time - *first_};
  joiner_.join({at->anchor, at->T_anchor_first, at->covariance, at->T_map_odom});
}

}  // namespace sgraphs
