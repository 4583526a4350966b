#include "perception/odometry/odometry_node.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <utility>

#include "common/base/error.h"
#include "common/bus/status.h"

namespace sgraphs {
namespace {

// A stamp further than this from all others is an error of its source and would stop the queue for good.
constexpr Duration kMaxTimeJump{3'600'000'000};
// UDP reorders by less than this.
constexpr Duration kMaxReorder{100'000};
// A sweep in more chunks than this is no sweep (2800 points each).
constexpr int kMaxSweepChunks = 1000;
// To be raised with every change of what visitState() lists, anywhere.
constexpr int32_t kStateVersion = 2;

}  // namespace

OdometryNode::OdometryNode(Bus& bus, OdometryParts parts, const std::string& odometry_override)
    : publisher_(bus), bus_(bus), parts_(std::move(parts)), odometry_override_(odometry_override) {
  if (!odometry_override.empty()) parseOdometryMode(odometry_override);
  const auto listen = [this](const auto& channel, auto handler) {
    subscribe(
        bus_, channel, [this, handler](const auto& m) { (this->*handler)(m); },
        [this, name = std::string(channel.name)] { gate_.reject(name, "undecodable"); });
  };
  listen(channels::kSession, &OdometryNode::onSession);
  listen(channels::kVelodynePackets, &OdometryNode::onPackets);
  listen(channels::kLidarPoints, &OdometryNode::onPoints);
  listen(channels::kSpotOdometry, &OdometryNode::onSpotOdometry);
  listen(channels::kStreamEnd, &OdometryNode::onStreamEnd);
}

void OdometryNode::onSession(const session_t& m) {
  if (done()) return;
  const std::string channel = channels::kSession.name;
  if (session_) {
    gate_.accept(channel, m.header);
    return;
  }
  std::optional<Session> session = fromMessage(m);
  if (!session)
    return gate_.reject(channel, "no session id, another schema, or content that cannot be right");
  if (!gate_.accept(channel, m.header)) return;
  if (!odometry_override_.empty()) session->odometry_mode = odometry_override_;
  if (session->odometryMode() != OdometryMode::kLidar && !session->has_odometry)
    throw Error("odometry mode '" + toString(session->odometryMode()) +
                "' needs SPOT_ODOMETRY, which this recording does not carry: use --odometry lidar");
  begin(m, std::move(*session));
}

void OdometryNode::begin(const session_t& m, Session session) {
  session_message_ = m;
  session_ = std::move(session);
  mode_ = session_->odometryMode();
  publisher_.setSession(session_->id);
  first_time_ = newest_time_ = session_->start;
  queue_ = ScanQueue(mode_ != OdometryMode::kLidar);
  // The legs alone hold nothing to compare them with.
  if (mode_ == OdometryMode::kFused) clock_.emplace(parts_.clock);
  decode_ = parts_.make_decoder();
  step_ = parts_.make_step(mode_, session_->T_body_lidar);
}

void OdometryNode::visitState(StateArchive& archive) {
  int32_t version = kStateVersion;
  archive(version);
  if (version != kStateVersion) throw Error("a checkpoint of version " + std::to_string(version));
  std::vector<uint8_t> message;
  if (!archive.reading()) message = encoded(*session_message_);
  archive(message);
  if (archive.reading()) {
    session_t m{};
    std::optional<Session> session;
    if (decode(message, m)) session = fromMessage(m);
    if (!session) throw Error("a checkpoint whose SESSION cannot be read");
    if (!odometry_override_.empty()) session->odometry_mode = odometry_override_;
    begin(m, std::move(*session));
  }
  parts_.visit_state(archive);
  if (clock_) archive(*clock_);
  archive(publisher_, gate_, queue_, first_time_, newest_time_, newest_packet_, heard_, scans_, oddities_);
}

bool OdometryNode::enter(const std::string& channel, const header_t& header) {
  if (done()) return false;
  if (!session_) {
    gate_.reject(channel, "before SESSION");
    return false;
  }
  return gate_.accept(channel, header);
}

bool OdometryNode::plausible(const std::string& channel, Time time) {
  if (time > newest_time_ + kMaxTimeJump || time < first_time_ - kMaxTimeJump) {
    gate_.reject(channel, "sensor time jumps by more than an hour");
    return false;
  }
  // SESSION of a live run is stamped by the host, whose clock may be minutes off the sensor's.
  if (!std::exchange(heard_, true)) first_time_ = newest_time_ = time;
  newest_time_ = std::max(newest_time_, time);
  return true;
}

void OdometryNode::onPackets(const velodyne_packets_t& m) {
  const std::string channel = channels::kVelodynePackets.name;
  if (!enter(channel, m.header)) return;
  const auto packets = fromMessage(m);
  if (!packets) return gate_.reject(channel, "counts that do not match");
  for (size_t i = 0; i < packets->size(); ++i) {
    const VelodynePacket& packet = (*packets)[i];
    // What the network has swapped the decoder refuses, packet by packet.
    if (packet.time < newest_packet_ - kMaxReorder) return gate_.reject(channel, "time runs backwards");
    if (!plausible(channel, packet.time)) return;
    newest_packet_ = std::max(newest_packet_, packet.time);
    const Stopwatch watch;
    std::optional<LidarScan> scan = decode_(packet);
    decode_latency_.add(watch.elapsedUs());
    if (scan) addScan(channel, std::move(*scan));
  }
  workOff();
}

void OdometryNode::onPoints(const lidar_points_t& m) {
  const std::string channel = channels::kLidarPoints.name;
  if (!enter(channel, m.header)) return;
  if (m.num_chunks < 1 || m.num_chunks > kMaxSweepChunks || m.chunk < 0 || m.chunk >= m.num_chunks)
    return gate_.reject(channel, "counts that do not match");
  if (m.chunk == 0) sweep_.clear();
  // A sweep that lost a chunk is left out: the gate has counted the loss.
  if (m.chunk != static_cast<int32_t>(sweep_.size()) || (m.chunk > 0 && m.sweep != sweep_.front().sweep))
    return sweep_.clear();
  sweep_.push_back(m);
  if (m.chunk + 1 < m.num_chunks) return;
  std::optional<LidarScan> scan = fromMessages(sweep_);
  sweep_.clear();
  if (!scan) return gate_.reject(channel, "counts that do not match");
  if (!plausible(channel, scan->end)) return;
  addScan(channel, std::move(*scan));
  workOff();
}

void OdometryNode::onSpotOdometry(const spot_odometry_t& m) {
  const std::string channel = channels::kSpotOdometry.name;
  if (!enter(channel, m.header)) return;
  const std::optional<BodyOdometry> sample = fromMessage(m);
  if (!sample) return gate_.reject(channel, "not a finite pose");
  if (!plausible(channel, sample->time) || mode_ == OdometryMode::kLidar) return;
  switch (queue_.addOdometry(*sample)) {
    case ScanQueue::Fate::kBackwards:
      return gate_.reject(channel, "time runs backwards");
    case ScanQueue::Fate::kLate:
      if (++oddities_["late odometry samples"] == 1)
        spdlog::warn("{}: odometry comes later than {} scans after its own and is dropped", channel,
                     ScanQueue::kPatience);
      return;
    case ScanQueue::Fate::kKept:
      if (clock_) clock_->addLegs(*sample);
      workOff();
  }
}

void OdometryNode::onStreamEnd(const stream_end_t& m) {
  if (!enter(channels::kStreamEnd.name, m.header)) return;
  for (const char* channel : {channels::kSession.name, channels::kVelodynePackets.name,
                              channels::kLidarPoints.name, channels::kSpotOdometry.name})
    closeChannel(gate_, m, channel);
  finish(m.why_not);
}

void OdometryNode::addScan(const std::string& channel, LidarScan scan) {
  if (queue_.addScan(std::move(scan)) == ScanQueue::Fate::kBackwards)
    gate_.reject(channel, "scan that does not end after the one before");
}

void OdometryNode::workOff() {
  while (std::optional<ScanQueue::Ready> ready = queue_.pop()) {
    if (!ready->complete) ++oddities_["scans without odometry up to their end"];
    const Stopwatch watch;
    const std::optional<OdometryEstimate> estimate = step_.scan(ready->scan, ready->odometry);
    if (estimate) publishScan(*estimate);
    const std::optional<Keyframe> keyframe =
        estimate && estimate->is_keyframe ? step_.take_keyframe() : std::nullopt;
    step_latency_.add(watch.elapsedUs());
    if (keyframe)
      for (keyframe_t& chunk : toMessages(*keyframe)) publisher_.send(channels::kKeyframe, chunk);
    if (estimate)
      followClock(*estimate);
    else
      ++oddities_["scans that could not be used"];
  }
}

void OdometryNode::publishScan(const OdometryEstimate& estimate) {
  ++scans_;
  odometry_t message = toMessage(estimate);
  publisher_.send(channels::kOdometry, message);
  publisher_.sendPlain(channels::kPoseOdom,
                       toPoseMessage(estimate.time, estimate.T_odom_body, estimate.twist_body));
}

// The offset changes between two scans, as a function of what came before the second.
void OdometryNode::followClock(const OdometryEstimate& estimate) {
  if (!clock_) return;
  const Duration before = clock_->inForce();
  clock_->addScan(estimate.time, estimate.T_odom_body, estimate.inlier_share >= 0 && !estimate.extrapolated);
  if (clock_->inForce() == before) return;
  spdlog::info(
      "the legs' clock is {:+.1f} ms against the LiDAR's (+- {:.1f} ms): their stamps are corrected by it",
      1e3 * clock_->inForce().seconds(), 1e3 * clock_->estimate()->sigma_s);
  queue_.setClockOffset(clock_->inForce());
}

std::optional<ClockOffset::Estimate> OdometryNode::legsClock() const {
  return clock_ ? clock_->estimate() : std::nullopt;
}

std::string OdometryNode::state() const {
  std::string state = done() ? "done" : session_ ? "running" : "waiting for SESSION";
  const std::optional<ClockOffset::Estimate> clock = legsClock();
  if (!clock) return state;
  return fmt::format("{}; legs' clock {:+.1f} ms (+- {:.1f}), {:+.1f} ms in force", state,
                     1e3 * clock->offset_s, 1e3 * clock->sigma_s, 1e3 * legsClockInForce().seconds());
}

void OdometryNode::finish(const std::string& why_not) {
  if (done()) return;
  queue_.close();
  workOff();
  stream_end_t end{};
  end.header.utime = newest_time_.us;
  end.why_not = gate_.trouble();
  if (!why_not.empty()) end.why_not += (end.why_not.empty() ? "" : "; ") + why_not;
  publisher_.addTo(end, channels::kOdometry.name);
  publisher_.addTo(end, channels::kKeyframe.name);
  publisher_.send(channels::kOdometryEnd, end);
  end_ = std::move(end);
}

void OdometryNode::repeatEnd() {
  if (end_) publish(bus_, channels::kOdometryEnd, *end_);
}

void OdometryNode::publishStatus() {
  status_t status = makeStatus("sgraphs-odometry", state(), gate_, publisher_, queue_.size(), step_latency_);
  status.header.utime = newest_time_.us;
  publisher_.send(channels::kStatusOdometry, status);
}

Duration OdometryNode::duration() const {
  return newest_time_ - first_time_;
}

}  // namespace sgraphs
