#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "common/types/session.h"

namespace sgraphs {

// What a log holds of one channel.
struct ChannelSummary {
  int64_t count = 0;
  int64_t bytes = 0;
  int64_t first_us = 0;  // log time
  int64_t last_us = 0;
  // Of our own channels only:
  std::string type;         // empty: not one of ours
  int64_t gaps = 0;         // messages missing by their sequence numbers
  int64_t undecodable = 0;  // not of the channel's type in this version

  double rate_hz() const;
};

struct LogSummary {
  int64_t events = 0;
  int64_t file_bytes = 0;
  int64_t first_us = 0, last_us = 0;  // smallest and largest log time
  int64_t backward_stamps = 0;        // events stamped earlier than the one before
  int64_t skipped_bytes = 0;
  bool truncated = false;
  std::map<std::string, ChannelSummary> channels;
  std::optional<Session> session;
  bool ended = false;   // STREAM_END is there
  int64_t num_own = 0;  // channels of ours
};

// Reads the whole log. Throws Error if it is none.
LogSummary summariseLog(const std::string& path);

// The summary as a table for people.
std::string toText(const LogSummary& summary, const std::string& path);

}  // namespace sgraphs
