#include "common/bus/input_gate.h"

#include <spdlog/spdlog.h>

namespace sgraphs {

bool InputGate::accept(const std::string& channel, const header_t& header, int64_t* lost_before) {
  if (lost_before) *lost_before = 0;
  if (header.session == 0) {
    reject(channel, "no session id");
    return false;
  }
  if (session_ == 0) session_ = header.session;
  if (header.session != session_) {
    reject(channel, "of another session");
    return false;
  }
  ChannelCount& count = counts_[channel];
  const auto boot = boot_.find(channel);
  if (boot != boot_.end() && header.boot < boot->second) {
    reject(channel, "from before a restart");
    return false;
  }
  if (boot != boot_.end() && header.boot > boot->second) {
    // A process that resumes goes on with its numbers; one that cannot begins again.
    if (header.seq <= count.last_seq) count.last_seq = -1;
    ++count.restarts;
    spdlog::warn("{}: the process that writes it was restarted", channel);
  }
  boot_[channel] = header.boot;
  // Ends are sent several times, since a datagram may be lost; a network may do the same to any message.
  if (header.seq == count.last_seq) return false;
  if (header.seq < count.last_seq) {
    reject(channel, "out of order");
    return false;
  }
  const int64_t lost = header.seq - count.last_seq - 1;
  if (lost > 0) {
    if (count.lost == 0) spdlog::warn("{}: {} message(s) lost before seq {}", channel, lost, header.seq);
    count.lost += lost;
    if (lost_before) *lost_before = lost;
  }
  count.last_seq = header.seq;
  ++count.accepted;
  return true;
}

bool InputGate::acceptSession(const std::string& channel, int64_t session) {
  if (session_ == 0) session_ = session;
  if (session == session_) return true;
  reject(channel, "of another session");
  return false;
}

void InputGate::reject(const std::string& channel, const std::string& why) {
  ++counts_[channel].rejected;
  if (++reasons_[channel][why] == 1) spdlog::warn("{}: message refused: {}", channel, why);
}

void InputGate::closeChannel(const std::string& channel, int64_t last_seq) {
  ChannelCount& count = counts_[channel];
  if (last_seq <= count.last_seq) return;
  if (count.lost == 0)
    spdlog::warn("{}: {} message(s) lost at the end of the stream", channel, last_seq - count.last_seq);
  count.lost += last_seq - count.last_seq;
  count.last_seq = last_seq;
}

std::string InputGate::trouble() const {
  std::string text;
  const auto append = [&](const std::string& part) { text += (text.empty() ? "" : "; ") + part; };
  for (const auto& [channel, count] : counts_) {
    if (count.lost > 0) append(std::to_string(count.lost) + " message(s) of " + channel + " lost");
    if (count.restarts > 0)
      append("the process that writes " + channel + " was restarted " + std::to_string(count.restarts) +
             " time(s)");
    const auto reasons = reasons_.find(channel);
    if (reasons == reasons_.end()) continue;
    for (const auto& [why, n] : reasons->second)
      append(std::to_string(n) + " message(s) of " + channel + " refused (" + why + ")");
  }
  return text;
}

}  // namespace sgraphs
