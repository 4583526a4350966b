#include "tools/spy/channel_monitor.h"

#include <algorithm>
#include <cinttypes>
#include <cstdio>

#include "common/bus/channels.h"
#include "drivers/recording/message_header.h"
#include "lcmtypes/describe/message_text.h"

namespace sgraphs::spy {
namespace {

// Our channels are held to their type; elsewhere the message itself says what it is.
std::string expectedType(const std::string& channel, Bus::Bytes bytes) {
  if (const channels::Row* row = channels::find(channel.c_str())) return row->type;
  const TypeDescription* type = typeOf(TypeCatalogue::ours(), bytes);
  return type ? type->name : "";
}

bool decodes(const std::string& type, Bus::Bytes bytes) {
  const TypeDescription* found = typeOf(TypeCatalogue::ours(), bytes);
  return found && found->name == type && isWholeMessage(TypeCatalogue::ours(), bytes);
}

}  // namespace

void ChannelMonitor::step(const std::string& channel, Bus::Bytes bytes, Time now) {
  ChannelState& state = channels_[channel];
  if (state.count++ == 0) state.first = now;
  state.last = std::max(state.last, now);
  const auto size = static_cast<int64_t>(bytes.size());
  state.bytes += size;
  if (window_) recent_[channel].push_back({now, size});
  if (window_)
    while (recent_[channel].front().time < now - *window_) recent_[channel].pop_front();
  if (state.type.empty()) state.type = expectedType(channel, bytes);
  if (state.type.empty()) return;
  if (!decodes(state.type, bytes)) {
    ++state.undecodable;
    return;
  }
  if (const auto header = readHeader(channel, bytes)) {
    state.numbered = true;
    state.lost += gaps_.try_emplace(channel, !window_).first->second.step(*header);
  }
}

ChannelMonitor::Rate ChannelMonitor::rateOf(const std::string& channel, Time now) const {
  const ChannelState& state = channels_.at(channel);
  int64_t count = state.count, bytes = state.bytes;
  double span_s = (state.last - state.first).seconds();
  if (window_) {
    count = bytes = 0;
    const Time since = now - *window_;
    for (const Passed& passed : recent_.at(channel)) {
      count += passed.time >= since;
      bytes += passed.time >= since ? passed.bytes : 0;
    }
    // While the channel is younger than the window.
    span_s = std::min(window_->seconds(), (now - state.first).seconds());
    return span_s > 0 ? Rate{static_cast<double>(count) / span_s, static_cast<double>(bytes) / span_s}
                      : Rate{};
  }
  if (count < 2 || span_s <= 0) return {};
  return {static_cast<double>(count - 1) / span_s, static_cast<double>(bytes) / span_s};
}

std::string ChannelMonitor::table(Time now) const {
  char line[256];
  std::snprintf(line, sizeof line, "%-28s %-20s %9s %8s %10s %7s %7s %8s\n", "channel", "type", "count", "Hz",
                "kB/s", "lost", "bad", "last [s]");
  std::string text = line;
  for (const auto& [name, state] : channels_) {
    const Rate rate = rateOf(name, now);
    const std::string lost = state.numbered ? std::to_string(state.lost) : "-";
    const std::string bad = state.type.empty() ? "-" : std::to_string(state.undecodable);
    std::snprintf(line, sizeof line, "%-28s %-20s %9" PRId64 " %8.2f %10.2f %7s %7s %8.1f\n", name.c_str(),
                  state.type.empty() ? "(not ours)" : state.type.c_str(), state.count, rate.hz,
                  rate.bytes_per_s * 1e-3, lost.c_str(), bad.c_str(), (now - state.last).seconds());
    text += line;
  }
  return text;
}

}  // namespace sgraphs::spy
