#include "common/bus/status.h"

namespace sgraphs {

status_t makeStatus(const std::string& process, const std::string& state, const InputGate& gate,
                    const Publisher& publisher, size_t queue_depth, const LatencyHistogram& step) {
  status_t m{};
  m.process = process;
  m.state = state;
  const auto add = [&m](const std::string& channel, const ChannelCount& count) {
    m.channel.push_back(channel);
    m.count.push_back(count.accepted);
    m.lost.push_back(count.lost);
    m.rejected.push_back(count.rejected);
    m.last_seq.push_back(count.last_seq);
  };
  for (const auto& [channel, count] : gate.counts()) add(channel, count);
  for (const auto& [channel, seq] : publisher.lastSeq()) add(channel, {seq + 1, 0, 0, seq});
  m.num_channels = static_cast<int32_t>(m.channel.size());
  m.queue_depth = static_cast<int32_t>(queue_depth);
  m.step_p50_us = step.percentileUs(0.5);
  m.step_p99_us = step.percentileUs(0.99);
  m.resident_bytes = residentBytes();
  return m;
}

}  // namespace sgraphs
