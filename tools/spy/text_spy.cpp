#include "tools/spy/text_spy.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>

#include "common/base/error.h"
#include "common/bus/channels.h"
#include "common/bus/lcm_bus.h"
#include "common/bus/log_file.h"
#include "lcmtypes/describe/message_text.h"
#include "tools/spy/channel_monitor.h"

namespace sgraphs::spy {
namespace {

constexpr char kFileScheme[] = "file://";
constexpr Duration kRateWindow{5'000'000};
constexpr double kOnceDuration_s = 2.0;  // two messages of whatever comes once a second
constexpr Duration kRefresh{1'000'000};
constexpr int kPoll_ms = 50;

// Monotonic; a spy decides nothing but when to draw.
Time now() {
  const auto since = std::chrono::steady_clock::now().time_since_epoch();
  return {std::chrono::duration_cast<std::chrono::microseconds>(since).count()};
}

// One message of the channel that is asked for.
void printMessage(std::FILE* out, const std::string& channel, Bus::Bytes bytes, int64_t number,
                  const std::string& when, size_t max_elements) {
  const TypeCatalogue& ours = TypeCatalogue::ours();
  const std::optional<std::string> text = messageText(ours, bytes, max_elements);
  std::fprintf(out, "--- %s %lld, %s%zu bytes%s%s\n%s", channel.c_str(), static_cast<long long>(number),
               when.c_str(), bytes.size(), text ? ", " : "", text ? typeOf(ours, bytes)->name.c_str() : "",
               text ? text->c_str() : "  not a message of this version\n");
  std::fflush(out);
}

std::string orKnownName(const std::string& channel) {
  return channels::find(channel.c_str()) ? "" : "; it is none of the channels in README.md: check its name";
}

class BusSpy {
 public:
  BusSpy(const TextSpyOptions& options, std::FILE* out) : options_(options), out_(out), bus_(options.url) {
    const auto handle = [this](const std::string& channel, Bus::Bytes bytes) { onMessage(channel, bytes); };
    if (options.channel.empty())
      bus_.subscribeAll(handle);
    else
      bus_.subscribe(options.channel, [this](Bus::Bytes bytes) { onMessage(options_.channel, bytes); });
  }

  void run() {
    const double limit_s = options_.duration_s.value_or(options_.once ? kOnceDuration_s : 0);
    const bool endless = !options_.duration_s && !options_.once;
    const Time begin = now();
    Time drawn = begin;
    bool enough = false;
    while (!enough && (endless || (now() - begin).seconds() < limit_s)) {
      bus_.dispatch(kPoll_ms);
      enough = options_.once && !options_.channel.empty() && heard_ > 0;
      if (options_.once || !options_.channel.empty() || now() - drawn < kRefresh) continue;
      drawn = now();
      draw();
    }
    if (heard_ == 0)
      throw Error("nothing heard " + (options_.channel.empty() ? "" : "of " + options_.channel + " ") +
                  "on the bus '" + (options_.url.empty() ? "LCM's default" : options_.url) + "' in " +
                  std::to_string(limit_s).substr(0, 4) +
                  " s: is a sender running, with the same URL, on the same network" + "?" +
                  (options_.channel.empty() ? "" : orKnownName(options_.channel)));
    if (options_.channel.empty()) draw();
  }

 private:
  void onMessage(const std::string& channel, Bus::Bytes bytes) {
    // LCM's own, of its self test.
    if (channel == "LCM_SELF_TEST") return;
    if (options_.channel.empty())
      monitor_.step(channel, bytes, now());
    else if (!options_.once || heard_ == 0)
      printMessage(out_, channel, bytes, heard_, "", options_.max_elements);
    ++heard_;
  }
  void draw() {
    const bool terminal = isatty(fileno(out_)) != 0 && !options_.once;
    std::fprintf(out_, "%s%s%s", terminal ? "\033[H\033[J" : "", monitor_.table(now()).c_str(),
                 terminal || options_.once ? "" : "\n");
    std::fflush(out_);
  }

  const TextSpyOptions& options_;
  std::FILE* out_;
  LcmBus bus_;
  ChannelMonitor monitor_{kRateWindow};
  int64_t heard_ = 0;
};

std::string logPath(const std::string& url) {
  const std::string path = url.substr(sizeof kFileScheme - 1);
  return path.substr(0, path.find('?'));
}

void spyOnLog(const TextSpyOptions& options, std::FILE* out) {
  const std::string path = logPath(options.url);
  LogReader reader(path);
  ChannelMonitor monitor(std::nullopt);
  std::optional<int64_t> begin_us;
  int64_t last_us = 0, printed = 0;
  while (const std::optional<LogEvent> event = reader.next()) {
    if (!begin_us) begin_us = event->timestamp_us;
    const double since_s = static_cast<double>(event->timestamp_us - *begin_us) * 1e-6;
    if (options.duration_s && since_s > *options.duration_s) break;
    last_us = std::max(last_us, event->timestamp_us);
    if (options.channel.empty()) {
      monitor.step(event->channel, event->bytes, Time{event->timestamp_us});
    } else if (event->channel == options.channel) {
      char when[32];
      std::snprintf(when, sizeof when, "at %.3f s, ", since_s);
      printMessage(out, event->channel, event->bytes, printed++, when, options.max_elements);
      if (options.once) break;
    }
  }
  if (options.channel.empty())
    std::fputs(monitor.table(Time{last_us}).c_str(), out);
  else if (printed == 0)
    throw Error("log '" + path + "' holds no message of " + options.channel +
                ": `sgraphs log info` lists what it holds" + orKnownName(options.channel));
}

}  // namespace

void runTextSpy(const TextSpyOptions& options, std::FILE* out) {
  if (options.url.rfind(kFileScheme, 0) == 0)
    spyOnLog(options, out);
  else
    BusSpy(options, out).run();
}

}  // namespace sgraphs::spy
