#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <thread>

#include "tools/cli/commands.h"
#include "tools/simulate/simulate.h"

namespace sgraphs::cli {
namespace {

void runSimulateCommand(const simulate::SimulateOptions& options) {
  const bool terminal = isatty(STDERR_FILENO) != 0;
  simulate::Progress progress;
  if (terminal)
    progress = [](double done_s, double total_s) {
      std::fprintf(stderr, "\rsimulated %.0f of %.0f s", done_s, total_s);
    };
  const auto result = simulate::simulate(options, progress);
  if (terminal) std::fprintf(stderr, "\n");
  for (const std::string& warning : result.warnings)
    std::fprintf(stderr, "sgraphs: warning: %s\n", warning.c_str());
  std::printf("%s: simulated %s, %.1f s, %.1f m walked, %lld packets, %lld odometry samples\n",
              options.output.c_str(), result.building.c_str(), result.duration_s, result.path_length_m,
              static_cast<long long>(result.packets), static_cast<long long>(result.odometry_samples));
  const simulate::FaultCounts& faults = result.faults;
  if (faults.total() > 0)
    std::printf("  packets lost %lld, silenced %lld, doubled %lld, out of order %lld, corrupted %lld\n",
                static_cast<long long>(faults.lost), static_cast<long long>(faults.silenced),
                static_cast<long long>(faults.duplicated), static_cast<long long>(faults.reordered),
                static_cast<long long>(faults.corrupted));
}

}  // namespace

void addSimulate(CLI::App& app) {
  auto options = std::make_shared<simulate::SimulateOptions>();
  options->num_threads = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  CLI::App* command = app.add_subcommand("simulate", "A building becomes a recorded log");
  command->footer(
      "Examples:\n"
      "  sgraphs simulate small_office -o run.lcmlog --truth truth --with-odometry\n"
      "  sgraphs simulate small_office -o run.lcmlog --set path.start_heading_deg=45 --set "
      "faults.packet_loss=0.05\n"
      "  sgraphs simulate house.sdf --waypoints walk.json -o run.lcmlog\n"
      "walk.json holds a list of waypoints, [[0, 0], [4, 0]], or a plan's path object; plans are described "
      "in\n"
      "config/scenes/README.md.");
  command
      ->add_option("scene", options->scene,
                   "Name of a shipped scene, path of a plan.json, or a mesh (PLY, OBJ, STL, DAE, SDF)")
      ->required();
  command->add_option("--waypoints", options->waypoints,
                      "File with a walk: needed for a mesh, replaces that of a plan");
  command->add_option("--set", options->overrides, "One item of the plan, key.path=value; may be repeated")
      ->expected(1)
      ->take_all();
  command->add_option("-o,--output", options->output, "Log to write")->required();
  command->add_option("--truth", options->truth_dir, "Folder for gt.tum, plan.json and mesh.ply");
  command->add_option("--seed", options->seed, "Seed of all noise")->capture_default_str();
  command->add_flag("--with-odometry", options->with_odometry, "Add the drifting odometry of the legs");
  command->add_option("--threads", options->num_threads, "Threads; the log does not depend on it")
      ->capture_default_str();
  command->callback([options] { runSimulateCommand(*options); });
}

}  // namespace sgraphs::cli
