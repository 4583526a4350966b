#include "common/bus/publisher.h"

namespace sgraphs {

int64_t Publisher::lastSeq(const std::string& channel) const {
  const auto found = last_seq_.find(channel);
  return found == last_seq_.end() ? -1 : found->second;
}

void Publisher::addTo(stream_end_t& end, const std::string& channel) const {
  end.channel.push_back(channel);
  end.last_seq.push_back(lastSeq(channel));
  end.num_channels = static_cast<int32_t>(end.channel.size());
}

void closeChannel(InputGate& gate, const stream_end_t& end, const std::string& channel) {
  for (size_t i = 0; i < end.channel.size(); ++i)
    if (end.channel[i] == channel) gate.closeChannel(channel, end.last_seq[i]);
}

}  // namespace sgraphs
