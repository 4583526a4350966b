#include "tools/run/status_board.h"

#include <algorithm>
#include <cstdarg>
#include <cstdio>
#include <numeric>

namespace sgraphs {
namespace {

// A process that reports at 1 Hz and has not been heard of for this long is worth a word.
constexpr double kSilent_s = 3;

std::string format(const char* pattern, ...) __attribute__((format(printf, 1, 2)));
std::string format(const char* pattern, ...) {
  char text[256];
  va_list arguments;
  va_start(arguments, pattern);
  std::vsnprintf(text, sizeof text, pattern, arguments);
  va_end(arguments);
  return text;
}

int64_t sum(const std::vector<int64_t>& counts) {
  return std::accumulate(counts.begin(), counts.end(), int64_t{0});
}

std::string clockText(double s) {
  const int whole = static_cast<int>(s);
  return format("%02d:%02d:%02d", whole / 3600, whole / 60 % 60, whole % 60);
}

}  // namespace

void StatusBoard::status(const std::string& channel, const status_t& m, double now_s) {
  processes_[channel] = {m, now_s};
}

void StatusBoard::graphUpdate(const graph_update_t& m) {
  rounds_ = std::max(rounds_, m.round + 1);
  keyframes_ = std::max(keyframes_, m.keyframe + 1);
}

void StatusBoard::rooms(const rooms_t& m) {
  if (m.chunk == 0) rooms_ = doorways_ = floors_ = 0;
  rooms_ += m.num_rooms;
  doorways_ += m.num_doorways;
  floors_ += m.num_floors;
}

void StatusBoard::takeRates(double now_s) {
  const double span_s = now_s - rates_s_;
  if (span_s <= 0) return;
  for (const auto& [channel, count] : counts_)
    rates_[channel] = static_cast<double>(count - counts_before_[channel]) / span_s;
  counts_before_ = counts_;
  rates_s_ = now_s;
}

double StatusBoard::rate(const std::string& channel) const {
  const auto found = rates_.find(channel);
  return found == rates_.end() ? 0 : found->second;
}

std::string StatusBoard::summary(double now_s) const {
  int64_t lost = 0, resident = 0;
  for (const auto& [channel, process] : processes_) {
    lost += sum(process.newest.lost);
    resident += process.newest.resident_bytes;
  }
  return format(
      "%s  scans %.1f/s  legs %.0f/s  keyframes %lld  rounds %lld  rooms %lld  doorways %lld  floors %lld  "
      "lost %lld  %lld MiB",
      clockText(now_s).c_str(), rate("ODOMETRY"), rate("SPOT_ODOMETRY"), static_cast<long long>(keyframes_),
      static_cast<long long>(rounds_), static_cast<long long>(rooms_), static_cast<long long>(doorways_),
      static_cast<long long>(floors_), static_cast<long long>(lost), static_cast<long long>(resident >> 20));
}

std::vector<std::string> StatusBoard::screen(double now_s, const std::map<std::string, int>& restarts) const {
  std::vector<std::string> lines{summary(now_s), ""};
  lines.push_back(format("%-24s %7s %9s %9s %6s %8s %6s %9s  %s", "process", "queue", "p50 ms", "p99 ms",
                         "lost", "refused", "MiB", "restarts", "state"));
  for (const auto& [channel, process] : processes_) {
    const status_t& m = process.newest;
    const auto restarted = restarts.find(channel);
    const double quiet_s = now_s - process.heard_s;
    const std::string state = quiet_s > kSilent_s ? format("not heard of for %.0f s", quiet_s) : m.state;
    lines.push_back(format("%-24s %7d %9.2f %9.2f %6lld %8lld %6lld %9d  %s", m.process.c_str(),
                           m.queue_depth, static_cast<double>(m.step_p50_us) * 1e-3,
                           static_cast<double>(m.step_p99_us) * 1e-3, static_cast<long long>(sum(m.lost)),
                           static_cast<long long>(sum(m.rejected)),
                           static_cast<long long>(m.resident_bytes >> 20),
                           restarted == restarts.end() ? 0 : restarted->second, state.c_str()));
  }
  return lines;
}

}  // namespace sgraphs
