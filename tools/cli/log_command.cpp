#include <cstdio>
#include <memory>

#include "common/base/error.h"
#include "drivers/recording/log_edit.h"
#include "drivers/recording/log_latency.h"
#include "drivers/recording/log_summary.h"
#include "tools/cli/commands.h"

namespace sgraphs::cli {
namespace {

struct LogArguments {
  std::string input, output;
  LogSelection selection;
  std::vector<std::string> channels;
};

void addInfo(CLI::App& log) {
  auto path = std::make_shared<std::string>();
  CLI::App* command = log.add_subcommand("info", "List a log's channels, session and damage");
  command->add_option("LOG", *path, "LCM log")->required();
  command->footer("Example:\n  sgraphs log info run.lcmlog");
  command->callback([path] { std::fputs(toText(summariseLog(*path), *path).c_str(), stdout); });
}

void addLatency(CLI::App& log) {
  struct Channels {
    std::string log, from = "VELODYNE_PACKETS", to = "ODOMETRY";
  };
  auto channels = std::make_shared<Channels>();
  CLI::App* command =
      log.add_subcommand("latency", "How long one channel came after another while a log was recorded");
  command->add_option("LOG", channels->log, "LCM log that a recorder wrote")->required();
  command->add_option("--from", channels->from, "Channel of what comes in")->capture_default_str();
  command->add_option("--to", channels->to, "Channel of what is made of it")->capture_default_str();
  command->footer("Example:\n  sgraphs run --record rec --record-all …\n  sgraphs log latency rec/*.lcmlog");
  command->callback([channels] {
    const LogLatency latency = latencyIn(channels->log, channels->from, channels->to);
    std::fputs(toText(latency, channels->from, channels->to).c_str(), stdout);
  });
}

void copy(const LogArguments& arguments) {
  const int64_t events = copyLog(arguments.input, arguments.output, arguments.selection);
  std::printf("%s: %lld events\n", arguments.output.c_str(), static_cast<long long>(events));
}

void addCut(CLI::App& log) {
  auto arguments = std::make_shared<LogArguments>();
  CLI::App* command = log.add_subcommand("cut", "Copy a stretch of time");
  command->add_option("LOG", arguments->input, "LCM log")->required();
  command->add_option("--from", arguments->selection.from_s, "Begin, since the log's first event [s]");
  command->add_option("--to", arguments->selection.to_s, "End, since the log's first event [s]");
  command->add_option("-o,--output", arguments->output, "LCM log to write")->required();
  command->footer("Example:\n  sgraphs log cut run.lcmlog --from 10 --to 40 -o part.lcmlog");
  command->callback([arguments] {
    if (!(arguments->selection.from_s <= arguments->selection.to_s))
      throw UsageError("--from must not lie behind --to");
    copy(*arguments);
  });
}

void addFilter(CLI::App& log) {
  auto arguments = std::make_shared<LogArguments>();
  CLI::App* command = log.add_subcommand("filter", "Copy some channels (SESSION and STREAM_END stay)");
  command->add_option("LOG", arguments->input, "LCM log")->required();
  command->add_option("--channels", arguments->channels, "Channels to keep, A,B,…")
      ->required()
      ->delimiter(',');
  command->add_option("-o,--output", arguments->output, "LCM log to write")->required();
  command->footer("Example:\n  sgraphs log filter run.lcmlog --channels VELODYNE_PACKETS -o lidar.lcmlog");
  command->callback([arguments] {
    arguments->selection.channels = {arguments->channels.begin(), arguments->channels.end()};
    copy(*arguments);
  });
}

}  // namespace

void addLog(CLI::App& app) {
  CLI::App* log = app.add_subcommand("log", "Look into LCM logs, cut and filter them");
  log->require_subcommand(1);
  log->footer("Example:\n  sgraphs log info run.lcmlog");
  addInfo(*log);
  addLatency(*log);
  addCut(*log);
  addFilter(*log);
}

}  // namespace sgraphs::cli
