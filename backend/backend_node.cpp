#include "backend/backend_node.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <utility>

#include "backend/graph_messages.h"
#include "common/bus/status.h"
#include "lcmtypes/convert/convert.h"

namespace sgraphs {
namespace {

// Planes may come before the keyframe's own message does, by no more than what fits the queues.
constexpr int64_t kMaxPlanesAhead = 100;

// What a round waits for: of its keyframe, and of the round before. A row counts if SESSION lists its stage.
struct JoinedInput {
  const char* channel;
  const char* stage;
};
constexpr JoinedInput kKeyedByKeyframe[] = {{channels::kKeyframe.name, "odometry"},
                                            {channels::kKeyframePlanes.name, "planes"}};
constexpr JoinedInput kKeyedByRound[] = {{channels::kFreeSpace.name, "free-space"},
                                         {channels::kRooms.name, "rooms"},
                                         {channels::kLoopClosures.name, "loops"}};
constexpr const char* kStages[] = {
    "odometry", "planes", "free-space", "rooms", "loops", "backend", BackendNode::kScheduleStage};

bool keyedByRound(const std::string& channel) {
  return std::any_of(std::begin(kKeyedByRound), std::end(kKeyedByRound),
                     [&](const JoinedInput& input) { return channel == input.channel; });
}

}  // namespace

BackendNode::BackendNode(Bus& bus, BackendCore core, RoundJoiner::Mode mode)
    : bus_(bus), publisher_(bus), core_(std::move(core)), mode_(mode), joiner_(mode) {
  subscribe(
      bus_, channels::kSession, [this](const session_t& m) { onSession(m); },
      [this] { gate_.reject(channels::kSession.name, "undecodable"); });
  listen(channels::kOdometry, &BackendNode::onOdometry);
  listen(channels::kKeyframe, &BackendNode::onKeyframe);
  listen(channels::kKeyframePlanes, &BackendNode::onPlanes);
  const auto feedback = [this](const auto& channel) {
    early_.listen(bus_, gate_, channel, [this, channel](const auto& m) { onFeedback(channel, m); });
  };
  feedback(channels::kFreeSpace);
  feedback(channels::kRooms);
  feedback(channels::kLoopClosures);
  listen(channels::kOdometryEnd, &BackendNode::onOdometryEnd);
  listen(channels::kPlanesEnd, &BackendNode::onPlanesEnd);
  listen(channels::kStreamEnd, &BackendNode::onStreamEnd);
  if (mode_ == RoundJoiner::Mode::kWait) listen(channels::kRoundSchedule, &BackendNode::onSchedule);
}

template <typename Message>
void BackendNode::listen(const Channel<Message>& channel, void (BackendNode::*handler)(const Message&)) {
  early_.listen(bus_, gate_, channel, [this, handler](const Message& m) { (this->*handler)(m); });
}

void BackendNode::onSession(const session_t& m) {
  const std::string channel = channels::kSession.name;
  if (done()) return;
  const std::optional<Session> session = fromMessage(m);
  if (!session)
    return gate_.reject(channel, "no session id, another schema, or content that cannot be right");
  if (!gate_.accept(channel, m.header) || session_) return;
  session_ = session;
  publisher_.setSession(session->id);
  for (const std::string& stage : session->stages)
    if (std::find(std::begin(kStages), std::end(kStages), stage) == std::end(kStages))
      spdlog::warn("SESSION lists stage '{}', which this version does not have: rounds go on without it",
                   stage);
  const auto& stages = session->stages;
  if (mode_ == RoundJoiner::Mode::kWait &&
      std::find(stages.begin(), stages.end(), kScheduleStage) != stages.end())
    joiner_.expectSchedules();
  early_.open();
}

void BackendNode::onOdometry(const odometry_t& m) {
  const std::string channel = channels::kOdometry.name;
  int64_t lost_before = 0;
  if (done() || !gate_.accept(channel, m.header, &lost_before)) return;
  const std::optional<OdometryEstimate> estimate = fromMessage(m);
  if (!estimate) return gate_.reject(channel, "content that cannot be right");
  if (estimate->scan <= newest_scan_ || (newest_scan_ >= 0 && estimate->time <= newest_time_))
    return gate_.reject(channel, "a scan from the past");
  if (estimate->keyframe.value > announced_by_odometry_ + 1 + lost_before)
    return gate_.reject(channel, "a keyframe that cannot be");
  announced_by_odometry_ = std::max(announced_by_odometry_, estimate->keyframe.value);
  newest_scan_ = estimate->scan;
  newest_time_ = estimate->time;
  pending_.push_back(*estimate);
  advance();
}

void BackendNode::onKeyframe(const keyframe_t& m) {
  const std::string channel = channels::kKeyframe.name;
  int64_t lost_before = 0;
  if (done() || !gate_.accept(channel, m.header, &lost_before)) return;
  if (m.keyframe < next_keyframe_) return gate_.reject(channel, "its round is closed");
  if (m.keyframe > announced_by_keyframe_ + 1 + lost_before)
    return gate_.reject(channel, "a keyframe that cannot be");
  announced_by_keyframe_ = std::max(announced_by_keyframe_, m.keyframe);
  const KeyframeAssembly::Fate fate = assembly_.add(m);
  if (fate == KeyframeAssembly::Fate::kRefused) return gate_.reject(channel, "counts that do not match");
  if (fate == KeyframeAssembly::Fate::kComplete) joiner_.arrived({channel, m.keyframe, m.header.seq});
  advance();
}

void BackendNode::onPlanes(const keyframe_planes_t& m) {
  const std::string channel = channels::kKeyframePlanes.name;
  int64_t lost_before = 0;
  if (done() || !gate_.accept(channel, m.header, &lost_before)) return;
  if (m.keyframe < next_keyframe_) return gate_.reject(channel, "its round is closed");
  const int64_t newest = std::max({newest_planes_, announced_by_keyframe_, announced_by_odometry_});
  if (m.keyframe > newest + kMaxPlanesAhead + lost_before)
    return gate_.reject(channel, "a keyframe that cannot be");
  const std::optional<KeyframePlanes> planes = fromMessage(m);
  if (!planes) return gate_.reject(channel, "content that cannot be right");
  if (!joiner_.arrived({channel, m.keyframe, m.header.seq}))
    return gate_.reject(channel, "planes that came before, or too many ahead of their rounds");
  planes_[m.keyframe] = *planes;
  newest_planes_ = std::max(newest_planes_, m.keyframe);
  advance();
}

template <typename Message>
void BackendNode::onFeedback(const Channel<Message>& channel, const Message& m) {
  if (done() || !gate_.accept(channel.name, m.header)) return;
  switch (feedback_.add(m, rounds_)) {
    case RoundFeedback::Fate::kIncomplete:
      return;
    case RoundFeedback::Fate::kRefused:
      return gate_.reject(channel.name, "a round that cannot be, or chunks that do not match");
    case RoundFeedback::Fate::kUnreadable:
      gate_.reject(channel.name, "content that cannot be right");
      joiner_.lost(channel.name, m.round);
      break;
    case RoundFeedback::Fate::kComplete:
      if (!joiner_.arrived({channel.name, m.round, m.header.seq})) {
        feedback_.drop(channel.name, m.round);
        return gate_.reject(channel.name, "its round is closed");
      }
  }
  advance();
}

void BackendNode::onSchedule(const round_schedule_t& m) {
  const std::string channel = channels::kRoundSchedule.name;
  if (done() || !gate_.accept(channel, m.header)) return;
  std::vector<RoundJoiner::Output> outputs;
  for (size_t i = 0; i < m.channel.size(); ++i) outputs.push_back({m.channel[i], -1, m.seq[i]});
  if (m.round < rounds_) return gate_.reject(channel, "its round is closed");
  joiner_.schedule(m.round, outputs);
  advance();
}

void BackendNode::onStreamEnd(const stream_end_t& m) {
  if (done() || !gate_.accept(channels::kStreamEnd.name, m.header)) return;
  closeChannel(gate_, m, channels::kSession.name);
  stream_ended_ = true;
}

void BackendNode::onOdometryEnd(const stream_end_t& m) {
  if (done() || !gate_.accept(channels::kOdometryEnd.name, m.header)) return;
  closeChannel(gate_, m, channels::kOdometry.name);
  closeChannel(gate_, m, channels::kKeyframe.name);
  odometry_end_why_not_ = m.why_not;
  finishIfAllEnded();
}

void BackendNode::onPlanesEnd(const stream_end_t& m) {
  if (done() || !gate_.accept(channels::kPlanesEnd.name, m.header)) return;
  closeChannel(gate_, m, channels::kKeyframePlanes.name);
  planes_end_why_not_ = m.why_not;
  finishIfAllEnded();
}

void BackendNode::finishIfAllEnded() {
  if (!odometry_end_why_not_ || (takesPart("planes") && !planes_end_why_not_)) return;
  // A later stage repeats what it was told and adds to it.
  ending_ = planes_end_why_not_ ? *planes_end_why_not_ : *odometry_end_why_not_;
  input_ended_ = true;
  advance();
}

void BackendNode::advance() {
  while (session_ && !pending_.empty() && workOff(pending_.front())) pending_.pop_front();
  if (resting_ && pending_.empty()) endRest();
  if (ending_ && (pending_.empty() || !session_ || forced_)) endRun();
}

bool BackendNode::workOff(const OdometryEstimate& estimate) {
  while (next_keyframe_ <= estimate.keyframe.value) {
    const bool own = estimate.is_keyframe && estimate.keyframe.value == next_keyframe_;
    if (!own) {
      // Its ODOMETRY is lost, or an earlier one's: go to the next keyframe of which there is anything.
      const int64_t held = assembly_.firstFrom(next_keyframe_);
      const int64_t last = estimate.keyframe.value + (estimate.is_keyframe ? 0 : 1);
      next_keyframe_ = held < 0 ? last : std::min(held, last);
      if (next_keyframe_ == last) continue;
    }
    // The chunks are sent before ODOMETRY of the next scan. One more scan of patience lets datagrams that
    // overtook each other arrive.
    if (!keyframeRound(own ? &estimate : nullptr, !own || pending_.size() > 2 || input_ended_)) return false;
  }
  if (rounds_ > 0 && estimate.time - last_round_ >= kIdleAfter && !idleRound(estimate.time)) return false;
  publish(bus_, channels::kPose,
          toPoseMessage(estimate.time, newest_round_.T_map_odom * estimate.T_odom_body, estimate.twist_body));
  scans_.push_back(estimate);
  return true;
}

// Keyframes whose own ODOMETRY is lost and that no later one announced. False if a round has to wait.
bool BackendNode::workOffKeyframesLeft() {
  for (int64_t held = 0; session_ && (held = assembly_.firstFrom(next_keyframe_)) >= 0;) {
    next_keyframe_ = held;
    if (!keyframeRound(nullptr, true)) return false;
  }
  return true;
}

bool BackendNode::idleRound(Time time) {
  const RoundJoiner::Wants wants = feedbackWanted();
  if (!roundReady(wants)) return false;
  const RoundJoiner::Joined joined = joiner_.take(rounds_, wants);
  takeFeedback(joined);
  runRound({.round = rounds_, .time = time, .keyframe = {}}, joined);
  return true;
}

bool BackendNode::takesPart(const std::string& stage) const {
  if (!session_) return false;
  const auto& stages = session_->stages;
  return stages.empty() || stage == "odometry" ||
         std::find(stages.begin(), stages.end(), stage) != stages.end();
}

// The stage works in order: two later ones have come, or it has ended.
bool BackendNode::planesLost(int64_t keyframe) const {
  return input_ended_ || planes_end_why_not_ || newest_planes_ >= keyframe + 2;
}

// What is made of the newest round's map.
RoundJoiner::Wants BackendNode::feedbackWanted() const {
  RoundJoiner::Wants wants;
  if (rounds_ == 0 || feedback_taken_ == rounds_ - 1 || forced_) return wants;
  for (const JoinedInput& input : kKeyedByRound)
    if (takesPart(input.stage)) wants[input.channel] = rounds_ - 1;
  return wants;
}

// A live run decided what joins the round by its clock: the playback must not decide before it knows.
bool BackendNode::scheduleAwaited() const {
  if (mode_ == RoundJoiner::Mode::kLive || forced_ || !session_ || schedule_given_up_ >= rounds_)
    return false;
  const auto& stages = session_->stages;
  return std::find(stages.begin(), stages.end(), kScheduleStage) != stages.end() &&
         joiner_.newestSchedule() < rounds_;
}

bool BackendNode::roundReady(const RoundJoiner::Wants& wants) {
  if (forced_) joiner_.releaseSchedule(rounds_);
  return !scheduleAwaited() && joiner_.ready(rounds_, wants);
}

int64_t BackendNode::awaitedRound() const {
  const bool due = !pending_.empty() || ending_;
  if (done() || !due || (!scheduleAwaited() && joiner_.ready(rounds_, feedbackWanted()))) return -1;
  return std::max<int64_t>(rounds_ - 1, 0);
}

void BackendNode::giveUpAwaited() {
  if (scheduleAwaited()) {
    schedule_given_up_ = rounds_;
    ++missing_[channels::kRoundSchedule.name];
  }
  joiner_.releaseSchedule(rounds_);
  for (const auto& [channel, round] : feedbackWanted()) joiner_.lost(channel, round);
  advance();
}

void BackendNode::leaveOutAwaited() {
  for (const auto& [channel, round] : feedbackWanted()) {
    past_deadline_.insert(channel);
    joiner_.lost(channel, round);
  }
  advance();
}

int64_t BackendNode::awaitedPlanes() const {
  if (done() || pending_.empty() || !takesPart("planes") || planesLost(next_keyframe_)) return -1;
  const bool due = pending_.front().keyframe.value >= next_keyframe_;
  return due && !planes_.contains(next_keyframe_) ? next_keyframe_ : -1;
}

void BackendNode::giveUpPlanes() {
  joiner_.lost(channels::kKeyframePlanes.name, next_keyframe_);
  advance();
}

void BackendNode::takeFeedback(const RoundJoiner::Joined& joined) {
  for (const std::string& channel : joined.missing)
    past_deadline_.contains(channel) ? ++left_out_ : ++missing_[channel];
  past_deadline_.clear();
  feedback_taken_ = rounds_ - 1;
  for (const RoundJoiner::Output& output : joined.outputs)
    if (keyedByRound(output.input) && !feedback_.take(output.input, output.key))
      gate_.reject(output.input, "content that cannot be right");
}

bool BackendNode::keyframeRound(const OdometryEstimate* estimate, bool overdue) {
  RoundJoiner::Wants wants = feedbackWanted();
  for (const JoinedInput& input : kKeyedByKeyframe)
    if (takesPart(input.stage)) wants[input.channel] = next_keyframe_;
  if (overdue) joiner_.lost(channels::kKeyframe.name, next_keyframe_);
  if (planesLost(next_keyframe_)) joiner_.lost(channels::kKeyframePlanes.name, next_keyframe_);
  if (!roundReady(wants)) return false;
  const RoundJoiner::Joined joined = joiner_.take(rounds_, wants);
  takeFeedback(joined);
  RoundInput input{.round = rounds_, .time = {}, .keyframe = joinedKeyframe(estimate)};
  const auto are_its_planes = [&](const RoundJoiner::Output& o) {
    return o.input == channels::kKeyframePlanes.name && o.key == next_keyframe_;
  };
  if (std::any_of(joined.outputs.begin(), joined.outputs.end(), are_its_planes))
    input.planes = std::move(planes_.at(next_keyframe_));
  for (const JoinedInput& own : kKeyedByKeyframe) joiner_.forget(own.channel, next_keyframe_);
  ++next_keyframe_;
  planes_.erase(planes_.begin(), planes_.lower_bound(next_keyframe_));
  if (!input.keyframe) return true;
  input.time = input.keyframe->time;
  runRound(std::move(input), joined);
  return true;
}

std::optional<Keyframe> BackendNode::joinedKeyframe(const OdometryEstimate* estimate) {
  const bool came = assembly_.contains(next_keyframe_);
  std::optional<Keyframe> keyframe = assembly_.take(next_keyframe_);
  const SituationalGraph& graph = core_.graph();
  const bool in_order =
      keyframe && (graph.keyframes.empty() || graph.keyframes.rbegin()->second.time < keyframe->time);
  if (came && !in_order) gate_.reject(channels::kKeyframe.name, "content that cannot be right");
  if (in_order) return keyframe;
  if (estimate) return keyframeWithoutCloud(*estimate, session_->T_body_lidar);
  return std::nullopt;
}

void BackendNode::runRound(RoundInput input, const RoundJoiner::Joined& joined) {
  const Time time = input.time;
  const bool idle = !input.keyframe;
  const std::vector<map_chunk_t> map_chunks = idle ? std::vector<map_chunk_t>{} : mapChunks(*input.keyframe);
  if (mode_ == RoundJoiner::Mode::kLive) publishSchedule(input, joined);
  input.free_space = feedback_.freeSpace();
  input.rooms = feedback_.handOutRooms();
  input.loops = feedback_.handOutLoops();
  const Stopwatch watch;
  newest_round_ = core_.step(std::move(input));
  latency_.add(watch.elapsedUs());
  last_round_ = time;
  const int64_t round = rounds_++;
  for (graph_update_t& m : updateMessages(core_.graph(), newest_round_, round, time, idle))
    publisher_.send(channels::kGraphUpdate, m);
  for (map_chunk_t m : map_chunks) publisher_.send(channels::kMapChunk, m);
  map_to_odom_t map_to_odom{};
  map_to_odom.header.utime = time.us;
  map_to_odom.T_map_odom = toMessage(newest_round_.T_map_odom);
  publisher_.send(channels::kMapToOdom, map_to_odom);
  if (rounds_ % kSnapshotEvery == 0) publishSnapshot();
}

void BackendNode::publishSchedule(const RoundInput& input, const RoundJoiner::Joined& joined) {
  round_schedule_t m{};
  m.header.utime = input.time.us;
  m.round = input.round;
  m.keyframe = input.keyframe ? input.keyframe->id.value : -1;
  for (const RoundJoiner::Output& output : joined.outputs) {
    m.channel.push_back(output.input);
    m.seq.push_back(output.seq);
  }
  m.num_joined = static_cast<int32_t>(m.channel.size());
  publisher_.send(channels::kRoundSchedule, m);
}

void BackendNode::publishSnapshot() {
  for (graph_update_t& m : snapshotMessages(core_.graph(), newest_round_, rounds_ - 1, last_round_))
    publisher_.send(channels::kGraphSnapshot, m);
}

void BackendNode::finish(const std::string& why_not) {
  if (done()) return;
  forced_ = input_ended_ = true;
  ending_ = why_not;
  advance();
}

Time BackendNode::endOfScans() const {
  return scans_.empty() ? last_round_ : scans_.back().time;
}

// Idle rounds until rooms and poses have come to rest. False if one has to wait.
bool BackendNode::finalRounds() {
  const int quiet = takesPart("rooms") ? kQuietRounds : 1;
  while (rounds_ > 0 && final_rounds_ < kMaxFinalRounds && quiet_rounds_ < quiet) {
    // Forced: a recorded schedule asks for what will not come.
    if (!idleRound(endOfScans())) return forced_;
    ++final_rounds_;
    const bool changed = !newest_round_.changed.empty() || !newest_round_.changed_planes.empty() ||
                         newest_round_.changed_rooms || feedback_.searching();
    quiet_rounds_ = changed ? 0 : quiet_rounds_ + 1;
  }
  return true;
}

void BackendNode::endRun() {
  if (done() || (!workOffKeyframesLeft() && !forced_)) return;
  if (finalRounds()) conclude(endOfScans());
}

void BackendNode::rest() {
  resting_ = input_ended_ = true;
  advance();
}

void BackendNode::endRest() {
  if (!workOffKeyframesLeft() || !finalRounds()) return;
  resting_ = input_ended_ = false;
  final_rounds_ = quiet_rounds_ = 0;
}

void BackendNode::conclude(Time end) {
  if (rounds_ > 0) publishSnapshot();
  run_result_t m{};
  m.header.utime = end.us;
  m.graph_digest = newest_round_.graph_digest;
  m.rounds = rounds_;
  const auto because = [&m](const std::string& reason) {
    if (!reason.empty()) m.why_not += (m.why_not.empty() ? "" : "; ") + reason;
  };
  because(gate_.trouble());
  for (const auto& [channel, n] : missing_)
    because(std::to_string(n) + " " + channel + " incomplete when their round ran");
  if (!session_) because("no SESSION arrived");
  because(*ending_);
  for (const std::string& reason : feedback_.whyNot()) because(reason);
  m.reproducible = m.why_not.empty();
  publisher_.send(channels::kRunResult, m);
  result_ = std::move(m);
}

void BackendNode::repeatEnd() {
  if (result_) publish(bus_, channels::kRunResult, *result_);
}

void BackendNode::publishStatus() {
  std::string state = done() ? "done" : session_ ? "running" : "waiting for SESSION";
  if (left_out_ > 0) state += ", " + std::to_string(left_out_) + " answers joined later";
  status_t status = makeStatus("sgraphs-backend", state, gate_, publisher_,
                               pending_.size() + assembly_.size() + planes_.size(), latency_);
  status.header.utime = newest_time_.us;
  publisher_.send(channels::kStatusBackend, status);
}

}  // namespace sgraphs
