#pragma once

#include <optional>
#include <string>

#include "common/base/time.h"

namespace sgraphs {

// One exchange with the robot: client stamps in the host's clock, server stamps in the robot's.
struct RoundTrip {
  Time client_tx, server_rx, server_tx, client_rx;
};

// What the robot is told: nothing at first, then always the exchange before, with the identifier that it
// gave.
struct TimeSyncRequest {
  std::string clock_identifier;
  std::optional<RoundTrip> previous;
};

// robot = host + skew, as the robot estimates it from the exchange of least round trip.
struct ClockEstimate {
  Duration skew;
  Duration round_trip;
};

struct TimeSyncReply {
  enum class Status { kUnknown, kOk, kMoreSamples, kNotReady };
  Status status = Status::kUnknown;
  std::string clock_identifier;
  std::optional<ClockEstimate> best;
  RoundTrip exchange;
};

// Which exchange comes next, and when. Rounds follow each other until the robot says that its estimate holds;
// then a few at every interval. Times named `now` are of a clock that never jumps. Pure: sends nothing
// itself.
class TimeSync {
 public:
  explicit TimeSync(Duration interval) : interval_(interval) {}

  // When the next exchange shall be sent.
  Time due() const { return due_; }
  const TimeSyncRequest& request() const { return request_; }

  // An answer. One whose stamps cannot be right (it ends before it began, or took longer than 10 s) is left
  // out.
  void onReply(const TimeSyncReply& reply, Time now);
  // No answer came.
  void onFailure(Time now);
  // Begins again, without what was known: after a jump of a clock, or with a new connection.
  void restart(Time now);

  bool synced() const { return estimate_.has_value(); }
  const std::optional<ClockEstimate>& estimate() const { return estimate_; }
  bool robotNotReady() const { return not_ready_; }
  int rounds() const { return rounds_; }  // since the last rest

 private:
  Duration interval_;
  Time due_;
  TimeSyncRequest request_;
  std::optional<ClockEstimate> estimate_;
  int rounds_ = 0;
  bool not_ready_ = false;
};

}  // namespace sgraphs
