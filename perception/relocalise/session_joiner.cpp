#include "perception/relocalise/session_joiner.h"

#include <algorithm>
#include <utility>

#include "common/bus/channels.h"
#include "lcmtypes/convert/convert.h"

namespace sgraphs {
namespace {

// Between the map's last stamp and a session's first one, where the session's own clock says less.
constexpr Duration kPause{1'000'000};

}  // namespace

SessionJoiner::SessionJoiner(const MapEnd& map, Sink sink) : map_(map), sink_(std::move(sink)) {}

template <typename Release>
void SessionJoiner::passOrHold(size_t bytes, Release release) {
  if (joined_) return release();
  held_.emplace_back(std::move(release));
  held_bytes_ += bytes;
}

void SessionJoiner::seen(const header_t& header) {
  first_time_ = has_first_ ? std::min(first_time_, Time{header.utime}) : Time{header.utime};
  has_first_ = true;
}

template <typename Message>
void SessionJoiner::pass(const Message& m) {
  if (!joined_) seen(m.header);
  passOrHold(static_cast<size_t>(m.getEncodedSize()), [this, m] { release(m); });
}

void SessionJoiner::add(const odometry_t& m) {
  pass(m);
}

void SessionJoiner::add(const keyframe_t& m) {
  pass(m);
}

void SessionJoiner::add(const keyframe_planes_t& m) {
  pass(m);
}

void SessionJoiner::addOdometryEnd(const stream_end_t& m) {
  passOrHold(0, [this, m] { sink_.odometry_end(continued(m)); });
}

void SessionJoiner::addPlanesEnd(const stream_end_t& m) {
  passOrHold(0, [this, m] { sink_.planes_end(continued(m)); });
}

void SessionJoiner::join(const SessionStart& start) {
  start_ = start;
  joined_ = true;
  T_mapodom_odom_ = map_.T_map_odom.inverse() * start.T_map_odom;
  shift_ = std::max(Duration{}, map_.time + kPause - first_time_);
  for (const auto& release : std::exchange(held_, {})) release();
  held_bytes_ = 0;
}

void SessionJoiner::drop() {
  held_.clear();
  held_bytes_ = 0;
}

void SessionJoiner::continueHeader(header_t& header, const char* channel) const {
  header.session = map_.session;
  header.boot += map_.boot;
  header.utime += shift_.us;
  const auto last = map_.last_seq.find(channel);
  if (last != map_.last_seq.end()) header.seq += last->second + 1;
}

void SessionJoiner::continuePose(transform_t& T_odom_body) const {
  if (const auto T = fromMessage(T_odom_body)) T_odom_body = toMessage(T_mapodom_odom_ * *T);
}

void SessionJoiner::release(odometry_t m) const {
  continueHeader(m.header, channels::kOdometry.name);
  m.scan += firstScan();
  if (m.keyframe >= 0) m.keyframe += firstKeyframe().value;
  continuePose(m.T_odom_body);
  sink_.odometry(m);
}

void SessionJoiner::release(keyframe_t m) const {
  continueHeader(m.header, channels::kKeyframe.name);
  const bool first = m.keyframe == 0;
  m.keyframe += firstKeyframe().value;
  m.scan += firstScan();
  continuePose(m.T_odom_body);
  for (relative_pose_t& z : m.relative_poses) {
    z.from_keyframe += firstKeyframe().value;
    z.to_keyframe += firstKeyframe().value;
  }
  if (first) {
    RelativePose z;
    z.kind = RelativePoseKind::kNeighbour;
    z.from = start_.anchor;
    z.to = firstKeyframe();
    z.T_from_to = start_.T_anchor_first;
    z.covariance = start_.covariance;
    m.relative_poses = {toMessage(z)};
    m.num_relative_poses = 1;
  }
  sink_.keyframe(m);
}

void SessionJoiner::release(keyframe_planes_t m) const {
  continueHeader(m.header, channels::kKeyframePlanes.name);
  m.keyframe += firstKeyframe().value;
  sink_.planes(m);
}

// The session's ends are the first that the map's stages hear: those of earlier sessions ended no run.
stream_end_t SessionJoiner::continued(stream_end_t m) const {
  m.header.session = map_.session;
  m.header.utime += shift_.us;
  for (size_t i = 0; i < m.channel.size(); ++i) {
    const auto last = map_.last_seq.find(m.channel[i]);
    if (last != map_.last_seq.end()) m.last_seq[i] += last->second + 1;
  }
  return m;
}

}  // namespace sgraphs
