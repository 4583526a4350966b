#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "sgraphs/header_t.hpp"

namespace sgraphs {

// What a process knows of one channel it reads or writes.
struct ChannelCount {
  int64_t accepted = 0;
  int64_t lost = 0;
  int64_t rejected = 0;
  int64_t last_seq = -1;
  int64_t restarts = 0;  // of the process that writes the channel
};

// Checks the header of every message where it enters a process: messages of another session and old
// ones are refused, the newest one's repetition is passed over, jumps of the sequence number are counted as
// lost. Each kind of trouble is named once per channel.
class InputGate {
 public:
  // Whether the message shall be worked on. `lost_before` (optional) receives the number of messages missing
  // just before this one. The first accepted message fixes the session unless setSession was called. A
  // channel that starts above 0 has lost its beginning.
  bool accept(const std::string& channel, const header_t& header, int64_t* lost_before = nullptr);

  // For SESSION where it is heard by who may come late to a session that runs: its earlier repetitions were
  // not for them and are not lost. False, and refused, if it is of another session than the first one heard.
  bool acceptSession(const std::string& channel, int64_t session);

  // Counts a message that did not decode, or whose content is refused; `why` is named once per channel and
  // kind.
  void reject(const std::string& channel, const std::string& why);

  // Says that the publisher's last sequence number was `last_seq`; what is missing up to there is lost.
  void closeChannel(const std::string& channel, int64_t last_seq);

  void setSession(int64_t session) { session_ = session; }
  int64_t session() const { return session_; }  // 0: none yet

  // See StateArchive.
  void visitState(auto& archive) { archive(session_, counts_, boot_, reasons_); }

  const std::map<std::string, ChannelCount>& counts() const { return counts_; }

  // "2 messages of SPOT_ODOMETRY lost; 1 message of KEYFRAME rejected (…)"; empty if nothing was lost or
  // rejected.
  std::string trouble() const;

 private:
  int64_t session_ = 0;
  std::map<std::string, ChannelCount> counts_;
  std::map<std::string, int64_t> boot_;
  std::map<std::string, std::map<std::string, int64_t>> reasons_;  // per channel: reason -> count
};

}  // namespace sgraphs
