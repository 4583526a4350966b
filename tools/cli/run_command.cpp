#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>

#include "common/base/error.h"
#include "common/bus/lcm_bus.h"
#include "tools/cli/commands.h"
#include "tools/run/live_run.h"

namespace sgraphs::cli {
namespace {

// What summary.json says of the stages, as `sgraphs replay` prints it.
void reportStages(const std::string& out_dir) {
  std::ifstream in(out_dir + "/summary.json");
  const auto summary = nlohmann::json::parse(in, nullptr, false);
  if (summary.is_discarded()) return;
  const auto number = [](const nlohmann::json& values, const char* key) {
    return values.contains(key) && values[key].is_number() ? values[key].get<double>() : 0.0;
  };
  std::printf("%s: %.1f s of recording, %.0f MiB in the backend\n", out_dir.c_str(),
              number(summary, "duration_s"), number(summary, "peak_rss_mib"));
  if (!summary.contains("stages")) return;
  for (const auto& [stage, timing] : summary["stages"].items())
    std::printf("  %-10s p50 %8.2f ms   p99 %8.2f ms   max %8.2f ms   %.0f steps\n", stage.c_str(),
                number(timing, "p50_ms"), number(timing, "p99_ms"), number(timing, "max_ms"),
                number(timing, "count"));
}

void reportRun(const RunEnd& end, const RunOptions& options) {
  if (!end.result) {
    const std::string why = end.backend_said.empty() ? "it said nothing" : end.backend_said;
    throw Error("the backend ended with code " + std::to_string(end.backend_code) + " and no result (" + why +
                "): see " + options.out_dir + "/log");
  }
  reportStages(options.out_dir);
  if (!end.recording.empty()) std::printf("recording  %s\n", end.recording.c_str());
  if (end.restarts > 0) std::printf("restarts   %d (see %s/log)\n", end.restarts, options.out_dir.c_str());
  std::printf("rounds     %lld\ngraph_digest %s\n", static_cast<long long>(end.result->rounds),
              end.result->graph_digest.c_str());
  if (end.backend_code == kExitDone) return;
  if (end.backend_code == kExitNotReproducible) {
    std::fprintf(stderr, "sgraphs: not reproducible: %s\n", end.result->why_not.c_str());
    throw ExitCode{kExitNotReproducible};
  }
  throw Error("the backend ended with code " + std::to_string(end.backend_code) + ": " + end.backend_said);
}

void runRunCommand(RunOptions& options) {
  if (!options.pcap.empty() && !options.log.empty()) throw UsageError("give --pcap or --log, not both");
  if (options.record_all && options.record_dir.empty()) throw UsageError("--record-all needs --record DIR");
  if (!options.config_file.empty()) loadConfigFile(visitOf(options.config), options.config_file);
  for (const std::string& assignment : options.assignments)
    setConfigValue(visitOf(options.config), assignment);
  if (options.spot_host.empty()) options.spot_host = options.config.drivers.spot_bridge.host;
  if (!options.pcap.empty() || !options.log.empty()) options.spot_host.clear();
  options.lcm_url = fullLcmUrl(options.lcm_url);
  blockStopSignals();  // before LCM's thread is
  LiveRun live(options);
  reportRun(live.run(), options);
}

}  // namespace

void addRun(CLI::App& app) {
  auto options = std::make_shared<RunOptions>();
  CLI::App* command = app.add_subcommand("run", "All processes live, supervised; Ctrl-C ends them in order");
  command->footer(
      "Examples:\n"
      "  sgraphs run --spot 192.168.80.3 --T-body-lidar '0.12 0 0.31 0 0 0 1' --record recordings -o OUT\n"
      "  sgraphs run --pcap lidar.pcap -o OUT      without a sensor\n"
      "  sgraphs run --log run.lcmlog -o OUT       without a sensor and a robot");
  command
      ->add_option("-o,--output", options->out_dir, "Folder for the result, and for what the processes say")
      ->required();
  command->add_option("--record", options->record_dir, "Folder for a log of the raw channels (lcm-logger)");
  command->add_flag("--record-all", options->record_all, "Record every channel");
  command->add_option("--pcap", options->pcap, "Capture to play in place of a sensor")
      ->check(CLI::ExistingFile);
  command->add_option("--log", options->log, "Log to play in place of a sensor and a robot")
      ->check(CLI::ExistingFile);
  command->add_option("--rate", options->rate, "Speed of --pcap or --log")
      ->check(CLI::Range(0.01, 100.0))
      ->capture_default_str();
  command->add_option("--spot", options->spot_host,
                      "Address of a Spot whose odometry is used; default: drivers.spot_bridge.host");
  command->add_option(
      "--T-body-lidar", options->T_body_lidar,
      "LiDAR's mount on the body, \"x y z qx qy qz qw\"; default: drivers.session.T_body_lidar; a log "
      "brings its own");
  command->add_option(
      "--odometry", options->odometry,
      "Odometry factor: lidar, encoder or fused; default: fused if there is odometry, else lidar");
  command->add_option("--config", options->config_file,
                      "YAML file of settings (config/sgraphs.yaml has them all)");
  command->add_option("--set", options->assignments, "One setting, section.key=value; may be repeated")
      ->expected(1)
      ->take_all();
  command->add_option("--lcm-url", options->lcm_url,
                      "LCM provider; default: $LCM_DEFAULT_URL, else LCM's own");
  command->callback([options] { runRunCommand(*options); });
}

}  // namespace sgraphs::cli
