#include "drivers/recording/log_latency.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "common/base/error.h"
#include "common/bus/log_file.h"
#include "drivers/recording/message_header.h"

namespace sgraphs {
namespace {

int64_t percentile(const std::vector<int64_t>& sorted, double share) {
  const double rank = std::ceil(share * static_cast<double>(sorted.size()));
  return sorted[static_cast<size_t>(std::max(rank, 1.0)) - 1];
}

}  // namespace

LogLatency latencyIn(const std::string& log, const std::string& from, const std::string& to) {
  std::map<int64_t, int64_t> recorded_at;  // stamp of a message of `from` -> when it was recorded
  std::vector<int64_t> latencies_us;
  LogLatency result;
  bool has_from = false, has_to = false;
  LogReader reader(log);
  while (const std::optional<LogEvent> event = reader.next()) {
    const bool is_to = event->channel == to;
    if (!is_to && event->channel != from) continue;
    const std::optional<header_t> header = readHeader(*event);
    if (!header) continue;
    if (!is_to) {
      has_from = true;
      recorded_at[header->utime] = event->timestamp_us;
      continue;
    }
    has_to = true;
    const auto after = recorded_at.upper_bound(header->utime);
    if (after == recorded_at.begin())
      ++result.unpaired;
    else
      latencies_us.push_back(event->timestamp_us - std::prev(after)->second);
  }
  for (const auto& [channel, found] : {std::pair{from, has_from}, std::pair{to, has_to}})
    if (!found)
      throw UsageError("log '" + log + "' holds no message with a header on '" + channel +
                       "': `sgraphs log info` lists its channels");
  std::sort(latencies_us.begin(), latencies_us.end());
  result.count = static_cast<int64_t>(latencies_us.size());
  if (latencies_us.empty()) return result;
  result.p50_us = percentile(latencies_us, 0.5);
  result.p90_us = percentile(latencies_us, 0.9);
  result.p99_us = percentile(latencies_us, 0.99);
  result.max_us = latencies_us.back();
  return result;
}

std::string toText(const LogLatency& latency, const std::string& from, const std::string& to) {
  std::string text = fmt::format("{} after {}: {} messages", to, from, latency.count);
  if (latency.unpaired > 0) text += fmt::format(" ({} more with none before them)", latency.unpaired);
  if (latency.count > 0)
    text +=
        fmt::format(", p50 {:.1f} ms, p90 {:.1f} ms, p99 {:.1f} ms, at most {:.1f} ms",
                    1e-3 * static_cast<double>(latency.p50_us), 1e-3 * static_cast<double>(latency.p90_us),
                    1e-3 * static_cast<double>(latency.p99_us), 1e-3 * static_cast<double>(latency.max_us));
  return text + "\n";
}

}  // namespace sgraphs
