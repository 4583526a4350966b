#pragma once

#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "backend/backend.h"
#include "backend/round_feedback.h"
#include "backend/round_joiner.h"
#include "common/base/performance.h"
#include "common/bus/bus.h"
#include "common/bus/channels.h"
#include "common/bus/early_messages.h"
#include "common/bus/input_gate.h"
#include "common/bus/publisher.h"
#include "common/types/session.h"
#include "lcmtypes/convert/keyframe_assembly.h"

namespace sgraphs {

// The core that the node drives: a Backend, or what stands for it in a test.
struct BackendCore {
  std::function<RoundOutput(RoundInput)> step;
  std::function<const SituationalGraph&()> graph;
  std::function<std::map<std::string, FactorStatistics>()> factors;
  std::function<std::map<KeyframeId, Matrix6d>()> covariances = {};
};

// The backend on a bus. Scans are worked off in the order of ODOMETRY: a keyframe's scan first runs its
// round, a scan 5 s after the newest round runs an idle one, then POSE of the scan is published. Rounds are
// joined by id, so that processes may race; see architecture.md, "Rounds".
class BackendNode {
 public:
  static constexpr Duration kIdleAfter{5'000'000};
  static constexpr int kMaxFinalRounds = 5;
  // Rooms are accepted on stable evidence: so many final rounds in a row must change nothing.
  static constexpr int kQuietRounds = 2;
  static constexpr int64_t kSnapshotEvery = 50;  // rounds

  // A stage that a live run's SESSION names: rounds of its playback wait for their ROUND_SCHEDULE.
  static constexpr const char* kScheduleStage = "schedule";

  // The bus must outlive the node. In live mode ROUND_SCHEDULE is written, else it is read and obeyed.
  BackendNode(Bus& bus, BackendCore core, RoundJoiner::Mode mode = RoundJoiner::Mode::kWait);

  // Ends a run whose ODOMETRY_END or PLANES_END does not come: works off what is held without waiting for
  // anything, runs the final rounds, publishes RUN_RESULT. `why_not`: why another run may differ; empty if it
  // may not.
  void finish(const std::string& why_not);
  // Brings the map to rest as the end of a run does, with final rounds, and goes on: what comes next is of
  // another session. As many of the bus's messages later as the stages' answers take, resting() is over.
  void rest();
  bool resting() const { return resting_; }
  // Of the newest round.
  const std::string& graphDigest() const { return newest_round_.graph_digest; }
  const SE3& T_map_odom() const { return newest_round_.T_map_odom; }
  // The round whose FREE_SPACE, ROOMS and LOOP_CLOSURES the next one waits for; -1: none. What a datagram
  // lost is sent by nobody again: the caller, who has a clock, lets the round go on without.
  int64_t awaitedRound() const;
  void giveUpAwaited();
  // Live mode: the deadline of awaitedRound() has passed. The next round runs without, ROUND_SCHEDULE says
  // so, and what comes later joins a later round: nothing is lost.
  void leaveOutAwaited();
  // The keyframe whose round waits for KEYFRAME_PLANES; -1: none. Planes have no deadline, since what they
  // saw belongs to their own keyframe; but a process that is gone must not hold the map for ever.
  int64_t awaitedPlanes() const;
  void giveUpPlanes();
  // Sends RUN_RESULT once more, for a reader that lost it (same sequence number).
  void repeatEnd();
  void publishStatus();

  bool done() const { return result_.has_value(); }
  // STREAM_END was heard: ODOMETRY_END should follow soon.
  bool streamEnded() const { return stream_ended_; }
  // Nothing more comes from upstream: the final rounds are on.
  bool inputEnded() const { return input_ended_; }
  // Live mode: answers that their rounds went without.
  int64_t leftOut() const { return left_out_; }
  const run_result_t& result() const { return *result_; }  // done() only

  const SituationalGraph& graph() const { return core_.graph(); }
  std::map<std::string, FactorStatistics> factors() const { return core_.factors(); }
  // Of T_map_body, as Backend::keyframeCovariances().
  std::map<KeyframeId, Matrix6d> covariances() const {
    return core_.covariances ? core_.covariances() : std::map<KeyframeId, Matrix6d>{};
  }
  const std::optional<Session>& session() const { return session_; }
  const std::vector<OdometryEstimate>& scans() const { return scans_; }  // worked off, in order of time
  const InputGate& gate() const { return gate_; }
  const LatencyHistogram& roundLatency() const { return latency_; }
  int64_t rounds() const { return rounds_; }

 private:
  template <typename Message>
  void listen(const Channel<Message>& channel, void (BackendNode::*handler)(const Message&));
  void onSession(const session_t& m);
  void onOdometry(const odometry_t& m);
  void onKeyframe(const keyframe_t& m);
  void onPlanes(const keyframe_planes_t& m);
  template <typename Message>
  void onFeedback(const Channel<Message>& channel, const Message& m);
  void onSchedule(const round_schedule_t& m);
  void onOdometryEnd(const stream_end_t& m);
  void onPlanesEnd(const stream_end_t& m);
  void onStreamEnd(const stream_end_t& m);

  void advance();
  bool workOff(const OdometryEstimate& estimate);
  bool workOffKeyframesLeft();
  bool idleRound(Time time);
  Time endOfScans() const;
  bool finalRounds();
  void endRun();
  void endRest();
  void conclude(Time end);
  bool keyframeRound(const OdometryEstimate* estimate, bool overdue);
  std::optional<Keyframe> joinedKeyframe(const OdometryEstimate* estimate);
  void finishIfAllEnded();
  bool takesPart(const std::string& stage) const;
  bool scheduleAwaited() const;
  bool roundReady(const RoundJoiner::Wants& wants);
  bool planesLost(int64_t keyframe) const;
  RoundJoiner::Wants feedbackWanted() const;
  void takeFeedback(const RoundJoiner::Joined& joined);
  void runRound(RoundInput input, const RoundJoiner::Joined& joined);
  void publishSchedule(const RoundInput& input, const RoundJoiner::Joined& joined);
  void publishSnapshot();

  Bus& bus_;
  Publisher publisher_;
  BackendCore core_;
  RoundJoiner::Mode mode_;
  InputGate gate_;
  RoundJoiner joiner_;
  KeyframeAssembly assembly_;

  std::optional<Session> session_;
  EarlyMessages early_;
  std::deque<OdometryEstimate> pending_;  // accepted, not yet worked off
  int64_t announced_by_odometry_ = -1;    // newest keyframe that ODOMETRY named
  int64_t announced_by_keyframe_ = -1;    // newest keyframe that KEYFRAME named
  int64_t newest_scan_ = -1;
  Time newest_time_;
  int64_t next_keyframe_ = 0;
  int64_t rounds_ = 0;
  Time last_round_;
  RoundOutput newest_round_;
  std::vector<OdometryEstimate> scans_;
  std::map<int64_t, KeyframePlanes> planes_;  // of keyframes whose rounds have not run, by keyframe
  int64_t newest_planes_ = -1;
  RoundFeedback feedback_;
  int64_t feedback_taken_ = -1;          // newest round
  std::set<std::string> past_deadline_;  // channels that the next round does not wait for
  int64_t left_out_ = 0;
  int64_t schedule_given_up_ = -1;          // newest round whose ROUND_SCHEDULE was given up
  std::map<std::string, int64_t> missing_;  // outputs that rounds went without, by channel
  std::optional<std::string> odometry_end_why_not_, planes_end_why_not_;  // of the stages that have ended
  bool input_ended_ = false;
  std::optional<std::string> ending_;  // the input is complete; why another run may differ
  bool forced_ = false;                // nothing is waited for any more
  bool resting_ = false;               // the end of a session that is not the run's
  int final_rounds_ = 0;
  int quiet_rounds_ = 0;  // final rounds in a row that changed nothing
  bool stream_ended_ = false;
  std::optional<run_result_t> result_;
  LatencyHistogram latency_;
};

}  // namespace sgraphs
