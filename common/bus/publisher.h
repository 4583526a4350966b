#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "common/bus/bus.h"
#include "common/bus/input_gate.h"
#include "sgraphs/stream_end_t.hpp"

namespace sgraphs {

// Stamps what a process writes: session, boot, and consecutive numbers per channel from 0.
class Publisher {
 public:
  // boot: the bus's, unless given.
  explicit Publisher(Bus& bus, std::optional<int64_t> boot = std::nullopt) : bus_(bus), boot_(boot) {}

  void setSession(int64_t session) { session_ = session; }
  int64_t session() const { return session_; }

  // Fills the header but for utime, which is the message's own, and returns the sequence number.
  template <typename Message>
  int64_t send(const Channel<Message>& channel, Message& message) {
    message.header.session = session_;
    message.header.boot = boot_.value_or(bus_.boot());
    message.header.seq = ++last_seq_.try_emplace(channel.name, -1).first->second;
    publish(bus_, channel, message);
    return message.header.seq;
  }

  // For messages without our header (POSE, POSE_ODOM): only counted.
  template <typename Message>
  void sendPlain(const Channel<Message>& channel, const Message& message) {
    ++last_seq_.try_emplace(channel.name, -1).first->second;
    publish(bus_, channel, message);
  }

  // Newest number per channel written; -1: none.
  const std::map<std::string, int64_t>& lastSeq() const { return last_seq_; }
  int64_t lastSeq(const std::string& channel) const;

  // See StateArchive.
  void visitState(auto& archive) { archive(session_, last_seq_); }

  // Adds a channel and its newest number to a stream's end.
  void addTo(stream_end_t& end, const std::string& channel) const;

 private:
  Bus& bus_;
  std::optional<int64_t> boot_;
  int64_t session_ = 0;
  std::map<std::string, int64_t> last_seq_;
};

// Closes the channels that a stream's end names, as far as this process reads them (`channel` alone).
void closeChannel(InputGate& gate, const stream_end_t& end, const std::string& channel);

}  // namespace sgraphs
