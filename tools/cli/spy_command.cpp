#include <memory>

#include "common/base/error.h"
#include "tools/cli/commands.h"
#include "tools/spy/graphic_spy.h"
#include "tools/spy/text_spy.h"

namespace sgraphs::cli {
namespace {

struct SpyArguments {
  spy::TextSpyOptions options;
  bool text = false;
  double duration_s = 0;
};

void runSpyCommand(SpyArguments& arguments, const CLI::App& command) {
  spy::TextSpyOptions& options = arguments.options;
  if (arguments.text) {
    if (command.count("--duration") > 0) options.duration_s = arguments.duration_s;
    spy::runTextSpy(options, stdout);
    return;
  }
  for (const char* option : {"--channel", "--once", "--duration", "--elements"})
    if (command.count(option) > 0) throw UsageError(std::string(option) + " goes with --text");
  if (options.url.rfind("file://", 0) == 0)
    throw UsageError("a log is looked at with --text: lcm-spy listens to a bus");
  spy::runGraphicSpy(options.url);
}

}  // namespace

void addSpy(CLI::App& app) {
  auto arguments = std::make_shared<SpyArguments>();
  spy::TextSpyOptions& options = arguments->options;
  CLI::App* command = app.add_subcommand(
      "spy",
      "Watch the channels: LCM's lcm-spy with our types and views, or a table for machines without a screen");
  command->add_option("--lcm-url", options.url, "Bus to watch; with --text also a log: file://run.lcmlog");
  command->add_flag("--text", arguments->text,
                    "A table of channels: type, rate, bandwidth, lost and undecodable messages");
  command->add_option("--channel", options.channel,
                      "With --text: print the messages of this channel, decoded");
  command->add_flag("--once", options.once,
                    "With --text: one table (after 2 s, or --duration), or one message");
  command->add_option("--duration", arguments->duration_s, "With --text: end after this time [s]")
      ->check(CLI::PositiveNumber);
  command->add_option("--elements", options.max_elements, "With --text: elements of an array to print")
      ->check(CLI::Range(0, 100'000'000))
      ->capture_default_str();
  command->footer(
      "Example:\n  sgraphs spy\n  sgraphs spy --text --once\n  sgraphs spy --text --channel ODOMETRY --once\n"
      "  sgraphs spy --text --lcm-url file://run.lcmlog");
  command->callback([arguments, command] { runSpyCommand(*arguments, *command); });
}

}  // namespace sgraphs::cli
