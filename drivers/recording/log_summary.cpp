#include "drivers/recording/log_summary.h"

#include <algorithm>
#include <cinttypes>
#include <cstdarg>
#include <cstdio>
#include <cstring>

#include "common/bus/channels.h"
#include "common/bus/log_file.h"
#include "drivers/recording/message_header.h"
#include "drivers/recording/sequence_gaps.h"
#include "lcmtypes/convert/convert.h"

namespace sgraphs {
namespace {

std::string format(const char* pattern, ...) __attribute__((format(printf, 1, 2)));
std::string format(const char* pattern, ...) {
  char line[512];
  va_list arguments;
  va_start(arguments, pattern);
  std::vsnprintf(line, sizeof line, pattern, arguments);
  va_end(arguments);
  return line;
}

void addEvent(const LogEvent& event, LogSummary& summary, std::map<std::string, SequenceGaps>& gaps) {
  ChannelSummary& channel = summary.channels[event.channel];
  if (channel.count++ == 0) {
    channel.first_us = event.timestamp_us;
    if (const channels::Row* row = channels::find(event.channel.c_str())) channel.type = row->type;
  }
  channel.bytes += static_cast<int64_t>(event.bytes.size());
  channel.last_us = event.timestamp_us;
  if (channel.type.empty()) return;
  if (!hasTypeOf(event)) {
    ++channel.undecodable;
    return;
  }
  if (event.channel == channels::kStreamEnd.name) summary.ended = true;
  session_t session{};
  if (!summary.session && event.channel == channels::kSession.name && decode(event.bytes, session))
    summary.session = fromMessage(session);
  const std::optional<header_t> header = readHeader(event);
  if (!header) return;
  channel.gaps += gaps.try_emplace(event.channel, true).first->second.step(*header);
}

std::string sessionLine(const LogSummary& summary) {
  if (summary.num_own == 0) return "session   none: the log holds no sgraphs channel\n";
  if (!summary.session) return "session   none: the log holds no SESSION message of this version\n";
  const Session& s = *summary.session;
  const SE3& T = s.T_body_lidar;
  return format("session   %" PRId64 ", written by %s, odometry %s, mode %s\n", s.id,
                s.writer.empty() ? "(unnamed)" : s.writer.c_str(), s.has_odometry ? "recorded" : "none",
                s.odometry_mode.empty() ? "default" : s.odometry_mode.c_str()) +
         format("mount     T_body_lidar  %.4f %.4f %.4f  %.6f %.6f %.6f %.6f  (x y z qx qy qz qw)\n",
                T.translation.x(), T.translation.y(), T.translation.z(), T.rotation.x(), T.rotation.y(),
                T.rotation.z(), T.rotation.w());
}

std::string troubleLines(const LogSummary& summary) {
  std::string text;
  if (summary.backward_stamps > 0)
    text += format("warning   %" PRId64 " time stamps run backwards\n", summary.backward_stamps);
  if (summary.truncated) text += "warning   truncated: the file ends in the middle of an event\n";
  if (summary.skipped_bytes > 0)
    text +=
        format("warning   %" PRId64 " bytes belong to no event and were skipped\n", summary.skipped_bytes);
  for (const auto& [name, channel] : summary.channels)
    if (channel.undecodable > 0)
      text += format("warning   %" PRId64 " message(s) of %s are not of type %s in this version\n",
                     channel.undecodable, name.c_str(), channel.type.c_str());
  if (summary.session && !summary.ended)
    text += "warning   no STREAM_END: the recording was cut off or is still going on\n";
  return text;
}

}  // namespace

double ChannelSummary::rate_hz() const {
  return last_us > first_us ? static_cast<double>(count - 1) * 1e6 / static_cast<double>(last_us - first_us)
                            : 0.0;
}

LogSummary summariseLog(const std::string& path) {
  LogReader reader(path);
  LogSummary summary;
  std::map<std::string, SequenceGaps> gaps;
  int64_t previous_us = 0;
  while (const std::optional<LogEvent> event = reader.next()) {
    const int64_t t = event->timestamp_us;
    if (summary.events++ == 0) summary.first_us = summary.last_us = previous_us = t;
    summary.backward_stamps += t < previous_us;
    summary.first_us = std::min(summary.first_us, t);
    summary.last_us = std::max(summary.last_us, t);
    previous_us = t;
    addEvent(*event, summary, gaps);
  }
  for (const auto& [name, channel] : summary.channels) summary.num_own += !channel.type.empty();
  summary.file_bytes = reader.fileBytes();
  summary.skipped_bytes = reader.skippedBytes();
  summary.truncated = reader.truncated();
  return summary;
}

std::string toText(const LogSummary& summary, const std::string& path) {
  std::string text =
      format("%s\nevents    %" PRId64 " in %.3f s of log time from %.6f, %" PRId64 " bytes\n", path.c_str(),
             summary.events, static_cast<double>(summary.last_us - summary.first_us) * 1e-6,
             static_cast<double>(summary.first_us) * 1e-6, summary.file_bytes);
  text += sessionLine(summary) + "\n";
  text += format("%-28s %-20s %8s %8s %12s %10s %10s %6s\n", "channel", "type", "count", "Hz", "bytes",
                 "first [s]", "last [s]", "lost");
  for (const auto& [name, c] : summary.channels) {
    const bool counted = !c.type.empty() && c.type != "pose_t";
    text += format("%-28s %-20s %8" PRId64 " %8.2f %12" PRId64 " %10.3f %10.3f %6s\n", name.c_str(),
                   c.type.empty() ? "(not ours)" : c.type.c_str(), c.count, c.rate_hz(), c.bytes,
                   static_cast<double>(c.first_us - summary.first_us) * 1e-6,
                   static_cast<double>(c.last_us - summary.first_us) * 1e-6,
                   counted ? std::to_string(c.gaps).c_str() : "-");
  }
  const std::string trouble = troubleLines(summary);
  return trouble.empty() ? text : text + "\n" + trouble;
}

}  // namespace sgraphs
