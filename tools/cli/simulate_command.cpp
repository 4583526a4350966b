#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <thread>

#include "tools/cli/commands.h"
#include "tools/simulate/simulate.h"

namespace sgraphs::cli {
namespace {

void run(const simulate::SimulateOptions& options) {
  const bool terminal = isatty(STDERR_FILENO) != 0;
  simulate::Progress progress;
  if (terminal)
    progress = [](double done_s, double total_s) {
      std::fprintf(stderr, "\rsimulated %.0f of %.0f s", done_s, total_s);
    };
  const auto result = simulate::simulate(options, progress);
  if (terminal) std::fprintf(stderr, "\n");
  std::printf("%s: %.1f s, %.1f m walked, %lld packets, %lld odometry samples\n", options.output.c_str(),
              result.duration_s, result.path_length_m, static_cast<long long>(result.packets),
              static_cast<long long>(result.odometry_samples));
}

}  // namespace

void addSimulate(CLI::App& app) {
  auto options = std::make_shared<simulate::SimulateOptions>();
  options->num_threads = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  CLI::App* command = app.add_subcommand("simulate", "A building becomes a recorded log");
  command->footer("Example:\n  sgraphs simulate small_office -o run.lcmlog --truth truth --with-odometry");
  command->add_option("scene", options->scene, "Name of a shipped scene, or path of a plan.json")->required();
  command->add_option("-o,--output", options->output, "Log to write")->required();
  command->add_option("--truth", options->truth_dir, "Folder for gt.tum, plan.json and mesh.ply");
  command->add_option("--seed", options->seed, "Seed of all noise")->capture_default_str();
  command->add_flag("--with-odometry", options->with_odometry, "Add the drifting odometry of the legs");
  command->add_option("--threads", options->num_threads, "Threads; the log does not depend on it")
      ->capture_default_str();
  command->callback([options] { run(*options); });
}

}  // namespace sgraphs::cli
