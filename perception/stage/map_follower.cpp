#include "perception/stage/map_follower.h"

#include <algorithm>
#include <utility>

namespace sgraphs {

MapFollower::MapFollower(StageIo& io, Work work) : io_(io), work_(std::move(work)) {
  io_.listen(channels::kKeyframe, [this](const keyframe_t& m) { onKeyframe(m); });
  io_.listen(channels::kGraphUpdate, [this](const graph_update_t& m) { onGraphUpdate(m); });
  io_.listen(channels::kOdometryEnd, [this](const stream_end_t& m) {
    if (!io_.accept(channels::kOdometryEnd, m)) return;
    closeChannel(io_.gate(), m, channels::kKeyframe.name);
    keyframes_ended_ = true;
    advance();
  });
  io_.listen(channels::kStreamEnd, [this](const stream_end_t& m) {
    stream_ended_ = io_.accept(channels::kStreamEnd, m) || stream_ended_;
  });
  io_.listen(channels::kRunResult, [this](const run_result_t& m) {
    if (io_.accept(channels::kRunResult, m)) io_.close();
  });
}

void MapFollower::onKeyframe(const keyframe_t& m) {
  int64_t lost_before = 0;
  if (!io_.accept(channels::kKeyframe, m, &lost_before) || !io_.takesPart()) return;
  // Each keyframe between has lost a message at least.
  if (m.keyframe <= worked_.value || m.keyframe - announced_ - 1 > lost_before)
    return io_.reject(channels::kKeyframe, "a keyframe that cannot be");
  const KeyframeAssembly::Fate fate = assembly_.add(m);
  if (fate == KeyframeAssembly::Fate::kRefused)
    return io_.reject(channels::kKeyframe, "counts that do not match");
  announced_ = std::max(announced_, m.keyframe);
  if (fate == KeyframeAssembly::Fate::kComplete) complete_.insert(m.keyframe);
  advance();
}

void MapFollower::onGraphUpdate(const graph_update_t& m) {
  std::optional<MapUpdate> update = map_updates_.add(m);
  if (!update) return;
  updates_.push_back(std::move(*update));
  advance();
}

// A message of a keyframe is lost if a later keyframe's has come: the odometry speaks in order.
bool MapFollower::cloudAwaited(KeyframeId keyframe) const {
  return !complete_.contains(keyframe.value) && announced_ <= keyframe.value && !keyframes_ended_;
}

void MapFollower::advance() {
  while (!updates_.empty()) {
    const MapUpdate& update = updates_.front();
    const bool brings_keyframe = !update.idle && update.newest > worked_;
    if (brings_keyframe && cloudAwaited(update.newest)) return;
    workOn(update);
    updates_.pop_front();
  }
}

void MapFollower::workOn(const MapUpdate& update) {
  std::optional<Keyframe> keyframe;
  if (!update.idle && update.newest > worked_) {
    const bool came = assembly_.contains(update.newest.value);
    keyframe = assembly_.take(update.newest.value);
    if (came && !keyframe) io_.reject(channels::kKeyframe, "content that cannot be right");
    worked_ = update.newest;
    complete_.erase(complete_.begin(), complete_.upper_bound(worked_.value));
  }
  newest_time_ = std::max(newest_time_, update.time);
  work_(keyframe, update);
}

}  // namespace sgraphs
