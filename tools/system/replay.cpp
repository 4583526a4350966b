#include "tools/system/replay.h"

#include <algorithm>
#include <set>
#include <utility>

#include "common/base/error.h"
#include "common/base/sha256.h"
#include "tools/system/run_record.h"

namespace sgraphs {
namespace {

// What the odometry says, what the planes do, and what of the source concerns other stages too. A stage that
// hears more gets a row here.
constexpr const char* kFromOdometry[] = {channels::kOdometry.name, channels::kKeyframe.name,
                                         channels::kOdometryEnd.name};
constexpr const char* kFromPlanes[] = {channels::kKeyframePlanes.name, channels::kPlanesEnd.name};
constexpr const char* kFromSource[] = {channels::kSession.name, channels::kRoundSchedule.name,
                                       channels::kStreamEnd.name};

}  // namespace

Replay::Replay(ReplayOptions options) : options_(std::move(options)) {
  if (!options_.odometry.empty()) parseOdometryMode(options_.odometry);
  odometry_.emplace(odometry_bus_, makeOdometryParts(options_.config, counts_), options_.odometry);
  planes_.emplace(session_bus_, makePlanesStep(options_.config));
  free_space_.emplace(bus_, makeFreeSpaceStep(options_.config));
  rooms_.emplace(bus_, makeRoomsStep(options_.config));
  loops_.emplace(bus_, makeLoopsStep(options_.config));
  backend_.emplace(bus_, makeBackendCore(options_.config));
  inspect();
  if (!options_.record.empty()) startRecording();
  if (!options_.map.empty()) earlier_.emplace(options_.map);
  if (!options_.out_dir.empty()) {
    map_log_ = std::make_unique<MapLogWriter>(options_.out_dir);
    map_log_->listenTo(bus_);
  }
  if (earlier_) loadMap();
  connect();
  feedBeginning();
}

void Replay::connect() {
  // A recording wants everything in one order.
  others_.emplace(session_bus_, options_.config.odometry.threads > 1 && !recording_);
  const auto forward = [this](const char* channel) {
    odometry_bus_.subscribe(channel, [this, channel](Bus::Bytes bytes) { others_->deliver(channel, bytes); });
  };
  for (const char* channel : kFromSource) forward(channel);
  for (const char* channel : kFromOdometry) forward(channel);
  if (earlier_) return connectRelocaliser();
  const auto pass = [this](const char* channel) {
    session_bus_.subscribe(channel, [this, channel](Bus::Bytes bytes) { publishOnMap(channel, bytes); });
  };
  for (const char* channel : kFromSource) pass(channel);
  for (const char* channel : kFromOdometry) pass(channel);
  for (const char* channel : kFromPlanes) pass(channel);
}

void Replay::publishOnMap(const std::string& channel, Bus::Bytes bytes) {
  bus_.publish(channel, bytes);
  bus_.dispatch(0);
}

// What a recorder on the bus of the real processes would see.
void Replay::startRecording() {
  recording_ = std::make_unique<LogWriter>(options_.record);
  const auto listen = [this](MemoryBus& bus, const char* channel) {
    bus.subscribe(channel, [this, channel](Bus::Bytes bytes) { recording_->write(now_us_, channel, bytes); });
  };
  for (const channels::Row& row : channels::table()) {
    const bool at_source = row.raw || row.name == std::string(channels::kPoseOdom.name);
    listen(at_source ? odometry_bus_ : bus_, row.name);
  }
}

// One pass over the log before the run: it must be one of ours, and a recorded schedule must be known before
// the rounds that it governs.
void Replay::inspect() {
  LogReader reader(options_.log);
  bool has_session = false;
  int32_t schema = -1;
  std::string writer;
  while (std::optional<LogEvent> event = reader.next()) {
    session_t session{};
    if (event->channel == channels::kRoundSchedule.name)
      schedules_.push_back(std::move(*event));
    else if (!has_session && event->channel == channels::kSession.name && decode(event->bytes, session)) {
      schema = session.schema;
      writer = session.writer;
      has_session = fromMessage(session).has_value();
      // Recorded where it stands: a recording that began at 0 could be played by nobody.
      now_us_ = event->timestamp_us;
      if (has_session) session_ = session;
    }
  }
  if (schema >= 0 && schema != kMessageSchema)
    throw Error("log '" + options_.log + "' was written by '" + writer + "' with message schema " +
                std::to_string(schema) + ", this version reads schema " + std::to_string(kMessageSchema) +
                ": replay it with the version that wrote it, or convert the recording again");
  if (!has_session)
    throw Error("log '" + options_.log +
                "' holds no SESSION: it is no recording of this program; make one with " +
                "`sgraphs convert` or `sgraphs simulate`");
  if (!schedules_.empty() && !obeysSchedule(session_)) {
    schedules_.clear();
    warnings_.push_back("log '" + options_.log +
                        "' is of a live run with another configuration, odometry mode, choice of layers or "
                        "map: its ROUND_SCHEDULE is not obeyed, rounds wait for all their inputs");
  }
  input_digest_ = sha256OfFile(options_.log);
}

// Every node sees the same SESSION. Schedules come before the first round.
void Replay::feedBeginning() {
  publish(odometry_bus_, channels::kSession, withStages(session_));
  odometry_bus_.dispatch(0);
  for (LogEvent& event : schedules_) {
    // Known from the beginning on.
    event.timestamp_us = now_us_;
    feed(event);
  }
  schedules_.clear();
}

void Replay::feed(const LogEvent& event) {
  now_us_ = std::max(now_us_, event.timestamp_us);
  odometry_bus_.publish(event.channel, event.bytes);
  odometry_bus_.dispatch(0);
}

// What joined a live round says something of the same stages with the same configuration only. The SESSION of
// a live run tells which they were.
bool Replay::obeysSchedule(const session_t& session) const {
  const std::set<std::string> ours(options_.stages.begin(), options_.stages.end());
  std::set<std::string> theirs(session.stages.begin(), session.stages.end());
  const bool is_live = theirs.erase(BackendNode::kScheduleStage) > 0;
  const bool same_stages = ours.empty() || theirs.empty() || ours == theirs;
  const bool same_config = !is_live || session.config_digest == digestOf(options_.config);
  const bool same_mode = options_.odometry.empty() || options_.odometry == session.odometry_mode;
  return same_stages && same_config && same_mode && options_.map.empty();
}

// With the stages that this replay was asked for. Schedules, known before the first round, are waited for by
// nobody.
session_t Replay::withStages(session_t session) const {
  if (!options_.stages.empty()) session.stages = options_.stages;
  std::erase(session.stages, BackendNode::kScheduleStage);
  session.num_stages = static_cast<int32_t>(session.stages.size());
  return session;
}

void Replay::run() {
  const Stopwatch watch;
  LogReader reader(options_.log);
  bool session_fed = false;
  while (std::optional<LogEvent> event = reader.next()) {
    const channels::Row* row = channels::find(event->channel.c_str());
    if (!row || !row->raw || event->channel == channels::kRoundSchedule.name) continue;
    // inspect() has fed the first SESSION already.
    session_t session{};
    if (!session_fed && event->channel == channels::kSession.name && decode(event->bytes, session) &&
        fromMessage(session)) {
      session_fed = true;
      continue;
    }
    feed(*event);
    if (options_.on_progress)
      options_.on_progress({false,
                            static_cast<double>(reader.position()) / static_cast<double>(reader.fileBytes()),
                            odometry_->duration().seconds(), watch.elapsedSeconds()});
  }
  if (reader.truncated())
    warnings_.push_back("log '" + options_.log +
                        "' ends in the middle of an event: what stands before it counts");
  if (reader.skippedBytes() > 0)
    warnings_.push_back(std::to_string(reader.skippedBytes()) + " bytes of log '" + options_.log +
                        "' belong to no event and were skipped");
  if (!odometry_->done()) endWithoutStreamEnd();
  others_->finish();
  if (relocalise_) {
    requireScans();
    requireFound();
  }
  // A stage of this process that gives no answer is a fault of ours, and no reason to lose what there is.
  if (!backend_->done()) backend_->finish("a stage did not answer every round");
  wall_s_ = watch.elapsedSeconds();
  if (recording_) recording_->close();
  requireScans();
  if (map_log_) map_log_->commit();
  for (const auto& [kind, n] : odometry_->oddities()) warnings_.push_back(std::to_string(n) + " " + kind);
  if (const std::string refused = describeRefused(*counts_); !refused.empty())
    warnings_.push_back("refused by the VLP-16 decoder: " + refused);
}

void Replay::endWithoutStreamEnd() {
  warnings_.push_back("log '" + options_.log + "' has no STREAM_END: the last complete scan counts");
  // The same bytes give the same result: nothing here is a reason against it.
  odometry_->finish("");
  odometry_bus_.dispatch(0);
}

void Replay::requireScans() const {
  if (relocalise_ ? relocalise_->heard() : backend_->rounds() > 0) return;
  std::string why = describeRefused(*counts_);
  for (const auto& [kind, n] : odometry_->oddities())
    why += (why.empty() ? "" : "; ") + std::to_string(n) + " " + kind;
  if (why.empty()) why = "no revolution of VELODYNE_PACKETS or sweep of LIDAR_POINTS is complete";
  throw Error("log '" + options_.log + "' gave no keyframe (" + why +
              "): check the recording with `sgraphs log info`");
}

RunRecord Replay::record() const {
  RunRecord record = recordOf(*backend_, options_.config);
  record.input_digest = input_digest_;
  if (relocalise_) {
    record.continued = continued();
    std::erase_if(record.scans, [&](const OdometryEstimate& scan) {
      return scan.scan < relocalise_->joiner().firstScan();
    });
  }
  record.duration_s = odometry_->duration().seconds();
  record.wall_s = wall_s_;
  record.realtime_factor = wall_s_ > 0 ? record.duration_s / wall_s_ : 0;
  record.stages["decode"] = timingOf(odometry_->decodeLatency());
  const auto add = [&record](const std::string& stage, const auto& node) {
    if (node.stepLatency().count() > 0) record.stages[stage] = timingOf(node.stepLatency());
    addGaps(record, node.gate());
  };
  add("odometry", *odometry_);
  add("planes", *planes_);
  add("free_space", *free_space_);
  add("rooms", *rooms_);
  add("loops", *loops_);
  if (relocalise_) add("relocalise", *relocalise_);
  if (const auto clock = odometry_->legsClock())
    record.legs_clock = RunRecord::LegsClock{1e3 * clock->offset_s, 1e3 * clock->sigma_s,
                                             1e3 * odometry_->legsClockInForce().seconds()};
  if (counts_->lost_packets > 0) record.gaps["lidar_packets"] = counts_->lost_packets;
  return record;
}

}  // namespace sgraphs
