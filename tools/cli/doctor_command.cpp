#include <cstdio>
#include <memory>
#include <optional>

#include "common/base/error.h"
#include "common/bus/lcm_bus.h"
#include "tools/cli/commands.h"
#include "tools/run/doctor.h"

namespace sgraphs::cli {
namespace {

struct DoctorArguments {
  DoctorOptions options;
  bool json = false, strict = false;
};

// Nothing if it is not valid, which is a finding of its own.
std::optional<SystemConfig> configOf(const DoctorOptions& options) {
  SystemConfig config;
  try {
    if (!options.config_file.empty()) loadConfigFile(visitOf(config), options.config_file);
    for (const std::string& assignment : options.assignments) setConfigValue(visitOf(config), assignment);
  } catch (const Error&) {
    return std::nullopt;
  }
  return config;
}

void runDoctorCommand(DoctorArguments& arguments) {
  DoctorOptions& options = arguments.options;
  options.lcm_url = fullLcmUrl(options.lcm_url);
  if (const std::optional<SystemConfig> config = configOf(options)) {
    options.data_port = config->drivers.velodyne_driver.data_port;
    options.position_port = config->drivers.velodyne_driver.position_port;
    if (options.spot_host.empty()) options.spot_host = config->drivers.spot_bridge.host;
  }
  std::vector<Finding> findings = examine(options);
  for (Finding& finding : findings)
    if (arguments.strict && finding.level == Finding::Level::kWarn) finding.level = Finding::Level::kFail;
  std::fputs((arguments.json ? toJson(findings) : toText(findings)).c_str(), stdout);
  if (!sound(findings)) throw ExitCode{kExitFailed};
}

}  // namespace

void addDoctor(CLI::App& app) {
  auto arguments = std::make_shared<DoctorArguments>();
  DoctorOptions& options = arguments->options;
  CLI::App* command =
      app.add_subcommand("doctor", "What this machine lacks for a live run, and how to mend it");
  command->footer(
      "Example:\n  sgraphs doctor --spot 192.168.80.3 --record recordings -o OUT\nExit code 1 if anything "
      "fails.");
  command->add_flag("--json", arguments->json, "For programs: {ok, checks: [{name, level, found, mend}]}");
  command->add_flag("--strict", arguments->strict,
                    "What is only doubtful fails, too (a LiDAR that is silent, …)");
  command->add_option("--lcm-url", options.lcm_url,
                      "LCM provider; default: $LCM_DEFAULT_URL, else LCM's own");
  command->add_option("--config", options.config_file, "YAML file of settings to check");
  command->add_option("--set", options.assignments, "One setting, section.key=value; may be repeated")
      ->expected(1)
      ->take_all();
  command->add_option("--spot", options.spot_host, "Address of the robot; default: drivers.spot_bridge.host");
  command->add_option("-o,--output", options.out_dir, "Folder that results shall go to");
  command->add_option("--record", options.record_dir, "Folder that recordings shall go to");
  command->callback([arguments] { runDoctorCommand(*arguments); });
}

}  // namespace sgraphs::cli
