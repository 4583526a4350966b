#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>

#include "common/base/time.h"
#include "common/bus/bus.h"
#include "drivers/recording/sequence_gaps.h"

namespace sgraphs::spy {

struct ChannelState {
  std::string type;       // empty: not one of ours
  bool numbered = false;  // its messages have sequence numbers
  int64_t count = 0;
  int64_t bytes = 0;
  int64_t lost = 0;         // by sequence numbers
  int64_t undecodable = 0;  // not a whole message of the channel's type
  Time first, last;         // of arrival
};

// What passes on each channel: counts, rates, gaps.
class ChannelMonitor {
 public:
  // window: rates are of this last stretch of time, and what came before the first message is not lost (a bus
  // that is watched); without one they are of all, from the beginning (a log).
  explicit ChannelMonitor(std::optional<Duration> window) : window_(window) {}

  void step(const std::string& channel, Bus::Bytes bytes, Time now);

  const std::map<std::string, ChannelState>& channels() const { return channels_; }
  // Messages and bytes per second, at a time no earlier than the last step's.
  struct Rate {
    double hz = 0;
    double bytes_per_s = 0;
  };
  Rate rateOf(const std::string& channel, Time now) const;

  // The channels by name, with a line of headings.
  std::string table(Time now) const;

 private:
  struct Passed {
    Time time;
    int64_t bytes;
  };

  std::optional<Duration> window_;
  std::map<std::string, ChannelState> channels_;
  std::map<std::string, SequenceGaps> gaps_;
  std::map<std::string, std::deque<Passed>> recent_;  // within the window only
};

}  // namespace sgraphs::spy
