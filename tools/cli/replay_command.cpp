#include <unistd.h>

#include <cstdio>
#include <memory>

#include "backend/output/run_outputs.h"
#include "common/base/error.h"
#include "common/base/performance.h"
#include "tools/cli/commands.h"
#include "tools/system/replay.h"

namespace sgraphs::cli {
namespace {

struct ReplayArguments {
  std::string log, out_dir, config_file, map_dir, record, odometry, layers = "floors";
  std::vector<std::string> assignments;
  int threads = 0;
};

SystemConfig configOf(const ReplayArguments& arguments) {
  SystemConfig config;
  if (!arguments.config_file.empty()) loadConfigFile(visitOf(config), arguments.config_file);
  for (const std::string& assignment : arguments.assignments) setConfigValue(visitOf(config), assignment);
  if (arguments.threads > 0) config.odometry.threads = arguments.threads;
  if (arguments.layers == "rooms") config.backend.floors.factors = false;
  return config;
}

// One line on a terminal, renewed twice a second.
std::function<void(const ReplayProgress&)> progressLine() {
  if (isatty(STDERR_FILENO) == 0) return {};
  return [watch = Stopwatch()](const ReplayProgress& p) mutable {
    if (watch.elapsedSeconds() < 0.5) return;
    watch.restart();
    if (p.loading) {
      std::fprintf(stderr, "\rloading the map %3.0f %%  ", 100 * p.share);
      return;
    }
    std::fprintf(stderr, "\rreplay %3.0f %%  %.0f s of recording  %.1f x real time ", 100 * p.share,
                 p.sensor_s, p.wall_s > 0 ? p.sensor_s / p.wall_s : 0.0);
  };
}

void reportReplay(const RunRecord& record, const std::string& out_dir) {
  std::printf("%s: %zu scans, %zu keyframes, %.1f s of recording in %.1f s (%.1f x real time), %.0f MiB\n",
              out_dir.c_str(), record.scans.size(), record.graph->keyframes.size(), record.duration_s,
              record.wall_s, record.realtime_factor, record.peak_rss_mib);
  if (const auto& map = record.continued)
    std::printf("continues a map of %lld keyframes, loaded in %.1f s; found beside %s after %.1f m, %.1f s\n",
                static_cast<long long>(map->keyframes), map->load_s, map->matched.str().c_str(),
                map->walked_m, map->after_s);
  for (const auto& [stage, timing] : record.stages)
    std::printf("  %-10s p50 %8.2f ms   p99 %8.2f ms   max %8.2f ms   %lld steps\n", stage.c_str(),
                timing.p50_ms, timing.p99_ms, timing.max_ms, static_cast<long long>(timing.count));
  std::printf("graph_digest %s\n", record.graph_digest.c_str());
}

// What takes part for the layers asked for. Not left to SESSION: old logs know fewer stages than there are
// now.
std::vector<std::string> stagesOf(const ReplayArguments& arguments) {
  if (arguments.layers == "keyframes") return {"odometry", "loops", "backend"};
  if (arguments.layers == "walls") return {"odometry", "planes", "loops", "backend"};
  return allStages();
}

void runReplayCommand(const ReplayArguments& arguments) {
  ReplayOptions options{arguments.log,  configOf(arguments), arguments.odometry, stagesOf(arguments),
                        progressLine(), arguments.record,    arguments.map_dir,  arguments.out_dir};
  Replay replay(std::move(options));
  replay.run();
  if (isatty(STDERR_FILENO) != 0) std::fprintf(stderr, "\r%60s\r", "");
  for (const std::string& warning : replay.warnings())
    std::fprintf(stderr, "sgraphs: warning: %s\n", warning.c_str());
  const RunRecord record = replay.record();
  writeOutputs(record, arguments.out_dir);
  reportReplay(record, arguments.out_dir);
  if (record.reproducible) return;
  std::fprintf(stderr, "sgraphs: not reproducible: %s\n", record.why_not.c_str());
  throw ExitCode{kExitNotReproducible};
}

}  // namespace

void addReplay(CLI::App& app) {
  auto arguments = std::make_shared<ReplayArguments>();
  CLI::App* command = app.add_subcommand("replay", "A recorded log becomes a map and a trajectory");
  command->footer(
      "Examples:\n"
      "  sgraphs replay run.lcmlog -o OUT --threads 2\n"
      "  sgraphs replay another_walk.lcmlog --map OUT -o OUT2    goes on with the map in OUT");
  command->add_option("log", arguments->log, "LCM log with SESSION and raw channels")->required();
  command->add_option("-o,--output", arguments->out_dir, "Folder for the result")->required();
  command->add_option("--config", arguments->config_file,
                      "YAML file of settings (config/sgraphs.yaml has them all)");
  command->add_option("--set", arguments->assignments, "One setting, section.key=value; may be repeated")
      ->expected(1)
      ->take_all();
  command->add_option("--threads", arguments->threads, "Worker threads; the result does not depend on it")
      ->check(CLI::Range(1, 64));
  command->add_option(
      "--odometry", arguments->odometry,
      "Odometry factor: lidar, encoder or fused; default: fused if the log has odometry, else lidar");
  command->add_option("--layers", arguments->layers, "Highest layer of the graph")
      ->check(CLI::IsMember({"keyframes", "walls", "rooms", "floors"}))
      ->capture_default_str();
  command->add_option("--map", arguments->map_dir,
                      "Output folder of an earlier replay whose map is continued");
  command->add_option("--record", arguments->record,
                      "Log that everything said on the bus is written to, for lcm-spy and lcm-logplayer");
  command->callback([arguments] { runReplayCommand(*arguments); });
}

}  // namespace sgraphs::cli
