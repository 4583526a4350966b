#include "tools/run/live_run.h"

#include <signal.h>

#include <chrono>
#include <filesystem>
#include <thread>
#include <utility>

#include "common/base/error.h"
#include "common/bus/channels.h"

namespace sgraphs {
namespace {

namespace fs = std::filesystem;
using Role = Supervisor::Role;

constexpr int kPoll_ms = 20;
constexpr double kStart_s = 30;       // for a process to say its first word
constexpr double kSourceStart_s = 5;  // for a source to begin to listen
constexpr double kSourceStop_s = 3;   // for a driver to send what it holds
constexpr double kDrain_s = 0.3;      // for what is on its way
constexpr double kRepeatEnd_s = 1;    // STREAM_END is said again until the odometry has heard it
constexpr double kResult_s = 600;     // for the backlog and the files of OUT
constexpr double kStageStop_s = 5;

Time hostClock() {
  using namespace std::chrono;
  return Time{duration_cast<microseconds>(system_clock::now().time_since_epoch()).count()};
}

void makeFolder(const std::string& path) {
  std::error_code failed;
  fs::create_directories(path, failed);
  if (failed) throw Error("cannot make folder '" + path + "': " + failed.message());
}

std::string recordingName(const RunOptions& options, const Session& session) {
  if (options.record_dir.empty()) return "";
  return options.record_dir + "/session_" + std::to_string(session.id) + ".lcmlog";
}

}  // namespace

LiveRun::LiveRun(RunOptions options)
    : options_(std::move(options)),
      bus_(options_.lcm_url),
      session_(bus_, sessionOf(options_, hostClock())),
      recording_(recordingName(options_, session_.session())),
      supervisor_(processTable(options_, recording_), options_.out_dir + "/log") {
  // Journals of an earlier run are of no use to this one.
  std::error_code none;
  fs::remove_all(options_.out_dir + "/state", none);
  if (!options_.record_dir.empty()) makeFolder(options_.record_dir);
  listen();
}

void LiveRun::listen() {
  for (const ProcessRow& row : supervisor_.rows()) {
    if (row.status_channel.empty()) continue;
    const Channel<status_t> channel{row.status_channel.c_str()};
    subscribe(
        bus_, channel,
        [this, name = row.status_channel](const status_t& m) {
          board_.status(name, m, since_start_.elapsedSeconds());
        },
        [] {});
  }
  const auto raw = [this](const auto& channel) {
    subscribe(
        bus_, channel,
        [this, name = std::string(channel.name)](const auto& m) {
          session_.heard(name, m.header);
          board_.count(name);
        },
        [] {});
  };
  raw(channels::kVelodynePackets);
  raw(channels::kLidarPoints);
  raw(channels::kSpotOdometry);
  subscribe(
      bus_, channels::kOdometry,
      [this](const odometry_t& m) {
        board_.count(channels::kOdometry.name);
        (void)m;
      },
      [] {});
  subscribe(
      bus_, channels::kGraphUpdate, [this](const graph_update_t& m) { board_.graphUpdate(m); }, [] {});
  subscribe(
      bus_, channels::kRooms, [this](const rooms_t& m) { board_.rooms(m); }, [] {});
  subscribe(
      bus_, channels::kRunResult,
      [this](const run_result_t& m) {
        if (m.header.session == session_.session().id) result_ = m;
      },
      [] {});
}

RunEnd LiveRun::run() {
  startListeners();
  startRecorder();
  session_.publishSession(session_.session().start);
  session_open_ = started_ = true;
  since_sources_.restart();
  supervisor_.start(Role::kSource);
  supervisor_.start(Role::kPlayer);
  watch();
  endStream();
  awaitBackend();
  stopRest();
  return {result_, supervisor_.exitCode(Role::kBackend).value_or(128 + SIGKILL),
          lastLineOf(supervisor_.outputOf("backend")), recording_, supervisor_.restarts()};
}

void LiveRun::dispatch() {
  bus_.dispatch(kPoll_ms);
  // A source that has just begun cannot wait for a second: what it has before it knows the session is lost.
  const bool begins = session_open_ && since_sources_.elapsedSeconds() < kSourceStart_s;
  if (begins && since_session_.elapsedSeconds() > 0.1) publishSession();
  if (stop_.requested()) ++stop_requests_;
  if (started_)
    for (const std::string& line : supervisor_.step()) screen_.say(line);
  if (second_.elapsedSeconds() < 1) return;
  second_.restart();
  everySecond();
}

// A log keeps its own clock.
void LiveRun::publishSession() {
  session_.publishSession(options_.log.empty() ? hostClock() : session_.session().start);
  since_session_.restart();
}

void LiveRun::everySecond() {
  const double now_s = since_start_.elapsedSeconds();
  if (session_open_ && since_session_.elapsedSeconds() > 0.9) publishSession();
  board_.takeRates(now_s);
  std::map<std::string, int> restarts;
  for (const ProcessRow& row : supervisor_.rows())
    restarts[row.status_channel] = supervisor_.restarts(row.name);
  if (session_open_ || stop_requests_ > 0) screen_.show(board_.screen(now_s, restarts));
}

template <typename Condition>
bool LiveRun::waitFor(double seconds, Condition condition) {
  const Stopwatch watch;
  const int stops = stop_requests_;
  while (!condition()) {
    if (watch.elapsedSeconds() > seconds || stop_requests_ > stops) return condition();
    dispatch();
  }
  return true;
}

void LiveRun::failIfEnded(Role role) {
  for (const ProcessRow& row : supervisor_.rows())
    if (row.role == role && supervisor_.endedEarly(row.name))
      throw Error(row.name + " ended before the run began: " + lastLineOf(supervisor_.outputOf(row.name)));
}

// Every process that reads is there before the first message is written: what it missed it would call lost.
void LiveRun::startListeners() {
  supervisor_.start(Role::kBackend);
  supervisor_.start(Role::kStage);
  const auto all_heard = [this] {
    failIfEnded(Role::kBackend);
    failIfEnded(Role::kStage);
    for (const ProcessRow& row : supervisor_.rows())
      if ((row.role == Role::kBackend || row.role == Role::kStage) && !board_.knows(row.status_channel))
        return false;
    return true;
  };
  if (waitFor(kStart_s, all_heard)) return;
  if (stop_requests_ > 0) throw Error("stopped before all processes were ready");
  for (const ProcessRow& row : supervisor_.rows())
    if ((row.role == Role::kBackend || row.role == Role::kStage) && !board_.knows(row.status_channel))
      throw Error(row.name + " said nothing on LCM within 30 s: " +
                  lastLineOf(supervisor_.outputOf(row.name)) + "; `sgraphs doctor` looks for the reason");
}

void LiveRun::startRecorder() {
  if (recording_.empty()) return;
  supervisor_.start(Role::kRecorder);
  const std::string probe = "sgraphs run";
  const auto writes = [&] {
    failIfEnded(Role::kRecorder);
    bus_.publish("LCM_SELF_TEST", {reinterpret_cast<const uint8_t*>(probe.data()), probe.size()});
    std::error_code none;
    return fs::exists(recording_, none) && fs::file_size(recording_, none) > 0;
  };
  if (!waitFor(kStart_s, writes))
    throw Error("lcm-logger wrote nothing to '" + recording_ +
                "' within 30 s: " + lastLineOf(supervisor_.outputOf("recorder")));
}

// Until the run is to end. Sources that come to an end by themselves are given time to be heard.
void LiveRun::watch() {
  while (stop_requests_ == 0) {
    dispatch();
    if (supervisor_.exitCode(Role::kBackend) && supervisor_.endedEarly("backend"))
      throw Error("backend ended: " + lastLineOf(supervisor_.outputOf("backend")));
    const bool plays = !options_.pcap.empty() || !options_.log.empty();
    if (!plays || supervisor_.running(Role::kPlayer)) continue;
    if (const int code = supervisor_.exitCode(Role::kPlayer).value_or(0); code != 0)
      screen_.say("the recording was not played to its end: " +
                  lastLineOf(supervisor_.outputOf(options_.log.empty() ? "velodyne-driver" : "player")));
    return;
  }
}

void LiveRun::endStream() {
  screen_.say("ending: the stream is closed, the rest is worked off");
  session_open_ = false;
  for (const Role role : {Role::kSource, Role::kPlayer}) supervisor_.stop(role, SIGTERM);
  waitFor(kSourceStop_s,
          [this] { return !supervisor_.running(Role::kSource) && !supervisor_.running(Role::kPlayer); });
  for (const Role role : {Role::kSource, Role::kPlayer}) supervisor_.kill(role);
  waitFor(kDrain_s, [] { return false; });
  const int restarts = supervisor_.restarts();
  const std::string why_not = restarts > 0 ? std::to_string(restarts) + " restart(s) of processes" : "";
  session_.publishEnd(why_not);
  waitFor(kRepeatEnd_s, [] { return false; });
  session_.publishEnd(why_not);
}

void LiveRun::awaitBackend() {
  if (waitFor(kResult_s, [this] { return !supervisor_.running(Role::kBackend); })) return;
  screen_.say(stop_requests_ > 1 ? "stopped at once"
                                 : "the backend gave no result within 10 minutes: stopped");
  supervisor_.stop(Role::kBackend, SIGTERM);
  waitFor(kStageStop_s, [this] { return !supervisor_.running(Role::kBackend); });
  supervisor_.kill(Role::kBackend);
}

void LiveRun::stopRest() {
  const auto ended = [this](Role role) { return [this, role] { return !supervisor_.running(role); }; };
  waitFor(kStageStop_s, ended(Role::kStage));
  supervisor_.stop(Role::kStage, SIGTERM);
  waitFor(kStageStop_s, ended(Role::kStage));
  supervisor_.kill(Role::kStage);
  supervisor_.stop(Role::kRecorder, SIGTERM);
  waitFor(kStageStop_s, ended(Role::kRecorder));
  supervisor_.kill(Role::kRecorder);
  screen_.leave();
}

}  // namespace sgraphs
