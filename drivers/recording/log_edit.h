#pragma once

#include <cstdint>
#include <limits>
#include <set>
#include <string>

namespace sgraphs {

// What a part of a log shall hold.
struct LogSelection {
  double from_s = 0;  // of log time since the log's first event
  double to_s = std::numeric_limits<double>::infinity();
  std::set<std::string> channels;  // empty: all
};

// Copies part of a log. A log of ours stays complete by itself: SESSION comes first and STREAM_END last, and
// sequence numbers start from 0, so that what was left out on purpose does not count as lost; messages that
// the input itself lacks still do. Returns the number of events copied. Throws Error if nothing is left,
// UsageError if a channel is not in the log.
int64_t copyLog(const std::string& input, const std::string& output, const LogSelection& selection);

}  // namespace sgraphs
