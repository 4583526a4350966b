#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>

#include "common/base/performance.h"
#include "common/types/session.h"
#include "drivers/spot/spot_bridge_config.h"
#include "drivers/spot/spot_robot.h"
#include "drivers/spot/stamp_mapper.h"

namespace sgraphs {

// A clock that never jumps, for pauses and deadlines; stamps come with the robot's answers.
using SteadyClock = std::function<Time()>;

// Calls of one kind.
struct CallCount {
  int64_t answered = 0;
  int64_t failed = 0;   // no connection, no answer in time
  int64_t refused = 0;  // the robot's error, or content that cannot be right
};

// From a robot's services to stamped odometry: logs in, asks the directory, synchronises clocks, polls the
// state, and begins again when the connection is lost. One call per step, nothing in between.
class SpotBridge {
 public:
  // The robot must outlive this.
  SpotBridge(SpotRobot& robot, const SpotBridgeConfig& config, Credentials credentials, SteadyClock clock);

  // When there is something to do.
  Time due() const { return due_; }

  // Does it, if it is due: at most one call. `poll`: ask for states, not only keep ready to. Returns a sample
  // stamped in the host's clock, later than the one before. Throws Error if the robot refuses the password.
  std::optional<BodyOdometry> step(bool poll);

  // One line for a status: what it does, or what hinders it.
  std::string state() const;

  bool synced() const { return sync_.synced(); }
  const std::map<std::string, CallCount>& counts() const { return counts_; }
  int64_t repeated() const { return repeated_; }
  const LatencyHistogram& latency() const { return latency_; }  // of the calls for a state

 private:
  void authenticate(TokenKeeper::Action action);
  void lookUp();
  void synchronise();
  std::optional<BodyOdometry> pollState();
  std::optional<BodyOdometry> sampleOf(const StateReply& reply);
  bool isPlausible(Time host, const StateReply& reply);

  void onFailure(const std::string& call, CallStatus status, const std::string& why);
  void onAnswered(const std::string& call);
  void refuse(const std::string& call, const std::string& why);
  void loseConnection(const std::string& why);

  SpotRobot& robot_;
  SpotBridgeConfig config_;
  Credentials credentials_;
  SteadyClock clock_;
  TokenKeeper token_;
  TimeSync sync_;
  StampMapper stamps_;
  Backoff reconnect_;

  Time due_;
  Time poll_due_;
  std::optional<Time> resynced_;
  std::map<std::string, std::string> authorities_;  // by service
  std::string hindrance_;                           // empty: none
  bool outage_ = false;
  int timeouts_in_a_row_ = 0;
  std::optional<Time> last_acquired_;
  double speed_mps_ = 0;

  std::map<std::string, CallCount> counts_;
  std::map<std::string, int64_t> reasons_;  // what was refused, named once each
  int64_t repeated_ = 0;
  LatencyHistogram latency_;
};

}  // namespace sgraphs
