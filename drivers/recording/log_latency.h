#pragma once

#include <cstdint>
#include <string>

namespace sgraphs {

// How long one channel's messages come after another's of which they are made, by the recorder's clock.
struct LogLatency {
  int64_t count = 0;                                       // messages of `to` that were measured
  int64_t unpaired = 0;                                    // of `to`, with no message of `from` before them
  int64_t p50_us = 0, p90_us = 0, p99_us = 0, max_us = 0;  // nearest rank
};

// Each message on `to` is held against the newest one on `from` that is stamped (header.utime) at or before
// it. Says something only of logs that a recorder wrote while the processes ran: a replay knows no time but
// the sensor's. Throws UsageError if a channel is not ours, has no header, or is not in the log.
LogLatency latencyIn(const std::string& log, const std::string& from, const std::string& to);

std::string toText(const LogLatency& latency, const std::string& from, const std::string& to);

}  // namespace sgraphs
