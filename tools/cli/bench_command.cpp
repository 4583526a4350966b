#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <memory>
#include <thread>

#include "common/base/error.h"
#include "common/io/text_file.h"
#include "tools/bench/accuracy/accuracy_bench.h"
#include "tools/bench/accuracy/benchmark_text.h"
#include "tools/bench/accuracy/child_process.h"
#include "tools/bench/accuracy/result_tables.h"
#include "tools/bench/baselines/run_baseline.h"
#include "tools/cli/commands.h"
#include "tools/simulate/scene/find_scene.h"

namespace sgraphs::cli {
namespace {

namespace fs = std::filesystem;

struct AccuracyArguments {
  bench::AccuracyOptions options;
  std::vector<std::string> scenes, tables{"ate", "map"}, layers = bench::filledLayers();
  bool all_scenes = false, no_baselines = false;
  std::string benchmark_file, commit, command;
};

// Folders beside a shipped scene that hold a plan, in order of names.
std::vector<std::string> shippedScenes() {
  const fs::path scenes = fs::path(simulate::findScene("small_office")).parent_path().parent_path();
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(scenes))
    if (fs::exists(entry.path() / "plan.json")) names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

std::vector<bench::TableSpec> tablesOf(const AccuracyArguments& a) {
  if (a.all_scenes && !a.scenes.empty()) throw UsageError("give --scenes or --all-scenes, not both");
  const std::vector<std::string> scenes = a.all_scenes ? shippedScenes() : a.scenes;
  std::vector<bench::TableSpec> tables;
  for (const std::string& id : a.tables)
    tables.push_back(id == "ate" ? bench::ateTable(a.layers, !a.no_baselines, scenes)
                                 : bench::mapTable(a.layers, !a.no_baselines, scenes));
  return tables;
}

std::string minutes(double seconds) {
  char text[32];
  std::snprintf(text, sizeof text, "%d:%02d", static_cast<int>(seconds) / 60, static_cast<int>(seconds) % 60);
  return text;
}

// On a terminal one line that is renewed, elsewhere a line for each run.
void showProgress(const bench::AccuracyProgress& p) {
  const bool terminal = isatty(STDERR_FILENO) != 0;
  std::fprintf(stderr, "%s[%zu/%zu] %s: done; %s min, %s left%s", terminal ? "\r\033[K" : "", p.finished,
               p.total, p.now.c_str(), minutes(p.elapsed_s).c_str(),
               p.remaining_s < 0 ? "not known what is" : ("about " + minutes(p.remaining_s) + " min").c_str(),
               terminal && p.finished < p.total ? "" : "\n");
}

std::string today() {
  const std::time_t now = std::time(nullptr);
  std::tm parts{};
  gmtime_r(&now, &parts);
  char text[16];
  std::strftime(text, sizeof text, "%Y-%m-%d", &parts);
  return text;
}

void printTables(const std::vector<bench::TableSpec>& tables, const std::vector<bench::RunResult>& results) {
  for (const bench::TableSpec& table : tables) {
    std::printf("%s: median (least–greatest) over the seeds%s\n%s\n", table.title.c_str(),
                table.completeness_figure.empty() ? "" : ", completeness (*: below 0.90, does not count)",
                bench::alignedText(bench::resultCells(table, results)).c_str());
    if (const auto printed = bench::printedCells(table); !printed.empty())
      std::printf("%s\n%s\n", bench::printedCaption(table).c_str(), bench::alignedText(printed).c_str());
  }
  std::printf("Medians of all else\n%s\n", bench::alignedText(bench::detailCells(tables, results)).c_str());
}

void runAccuracyCommand(AccuracyArguments& a) {
  bench::AccuracyOptions& options = a.options;
  options.program = bench::ownProgram();
  options.tables = tablesOf(a);
  options.threads = std::max(1, static_cast<int>(std::thread::hardware_concurrency()) / options.jobs);
  options.on_progress = showProgress;
  const auto results = bench::runAccuracy(options);
  printTables(options.tables, results);
  if (!a.benchmark_file.empty()) {
    const std::string old = fs::exists(a.benchmark_file) ? readFile(a.benchmark_file) : "";
    const bench::BenchmarkOrigin origin{a.command, SGRAPHS_VERSION, a.commit, today(), bench::machineText()};
    writeFile(a.benchmark_file,
              bench::withSection(old, bench::accuracySection(options.tables, results, origin)));
    std::printf("wrote %s\n", a.benchmark_file.c_str());
  }
  const auto failed = bench::failures(results);
  for (const std::string& line : failed) std::fprintf(stderr, "sgraphs: failed: %s\n", line.c_str());
  if (!failed.empty()) throw ExitCode{kExitFailed};
}

// As it can be typed again: no folder of this machine in front of the program's name.
std::string commandLine(const CLI::App& command) {
  std::string text = "sgraphs bench accuracy";
  for (const CLI::Option* option : command.get_options()) {
    if (option->count() == 0 || option->get_name() == "--output" ||
        option->get_name() == "--write-benchmark" || option->get_name() == "--commit" ||
        option->get_name() == "--report")
      continue;
    text += " " + option->get_name();
    std::string values;
    if (option->get_items_expected_max() > 0)
      for (const std::string& value : option->results()) values += (values.empty() ? "" : ",") + value;
    if (!values.empty()) text += " " + values;
  }
  return text;
}

void addAccuracy(CLI::App& bench_command) {
  auto a = std::make_shared<AccuracyArguments>();
  bench::AccuracyOptions& options = a->options;
  options.work_dir = "bench_accuracy";
  CLI::App* command = bench_command.add_subcommand(
      "accuracy", "The paper's tables on simulated buildings, beside baselines made of PCL");
  command
      ->add_option("-o,--output", options.work_dir, "Folder for results; what stands there is not made again")
      ->capture_default_str();
  command->add_option("--tables", a->tables, "Which tables: ate, map")
      ->delimiter(',')
      ->check(CLI::IsMember({"ate", "map"}))
      ->capture_default_str();
  command->add_option("--scenes", a->scenes, "Scenes in place of the paper's: names or plans, A,B,…")
      ->delimiter(',');
  command->add_flag("--all-scenes", a->all_scenes, "Every scene that is shipped");
  command->add_option("--layers", a->layers, "Our rows, A,B,…")
      ->delimiter(',')
      ->check(CLI::IsMember({"keyframes", "walls", "rooms", "floors"}))
      ->capture_default_str();
  command->add_flag("--no-baselines", a->no_baselines, "Leave PCL's rows out: they take most of the time");
  command->add_option("--seeds", options.seeds, "Recordings of each scene")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command->add_option("--first-seed", options.first_seed, "Seed of the first of them")->capture_default_str();
  command
      ->add_option("--set", options.settings,
                   "A setting of `sgraphs replay`, section.key=value; may be repeated")
      ->expected(1)
      ->take_all();
  command
      ->add_option("--jobs", options.jobs,
                   "Recordings worked on at once; times are then measured side by side")
      ->check(CLI::Range(1, 64))
      ->capture_default_str();
  command->add_flag("--fresh", options.fresh, "Results from before do not count");
  command->add_flag("--any-build", options.any_program, "Results of other builds of the program count, too");
  command->add_flag("--report", options.report_only,
                    "Tables of what stands in the folder; nothing is measured");
  command->add_flag("--keep", options.keep, "Keep recordings and OUT folders (gigabytes)");
  command->add_option("--write-benchmark", a->benchmark_file, "BENCHMARK.md to write the tables into");
  command->add_option("--commit", a->commit, "What to write into it as the program's commit");
  command->footer(
      "Example:\n  sgraphs bench accuracy -o bench_accuracy --jobs 2 --write-benchmark BENCHMARK.md\n  "
      "sgraphs "
      "bench accuracy --scenes small_office --seeds 5 --no-baselines");
  command->callback([a, command] {
    a->command = commandLine(*command);
    runAccuracyCommand(*a);
  });
}

struct BaselineArguments {
  bench::BaselineOptions options;
  std::string method = "gicp";
};

void runBaselineCommand(BaselineArguments& a) {
  a.options.baseline = bench::parseBaseline(a.method);
  const bool terminal = isatty(STDERR_FILENO) != 0;
  if (terminal)
    a.options.on_progress = [shown_s = 0.0](double sensor_s, double wall_s) mutable {
      if (wall_s < shown_s + 0.5) return;
      shown_s = wall_s;
      std::fprintf(stderr, "\r%.0f s of recording in %.0f s ", sensor_s, wall_s);
    };
  const bench::BaselineReport report = bench::runBaseline(a.options);
  if (terminal) std::fprintf(stderr, "\r%50s\r", "");
  std::printf(
      "%s: %lld scans, %.1f s of recording in %.1f s; scan p50 %.0f ms, p99 %.0f ms; %d matches failed\n",
      a.options.out_dir.c_str(), static_cast<long long>(report.scans), report.duration_s, report.wall_s,
      report.scan_p50_ms, report.scan_p99_ms, report.failed_matches);
  if (report.keyframes > 0)
    std::printf("  %lld keyframes, %d loops\n", static_cast<long long>(report.keyframes), report.loops);
}

void addBaselineSettings(CLI::App& command, bench::BaselineOptions& options) {
  const auto add = [&command](const char* name, double& value, const char* text) {
    command.add_option(name, value, text)->check(CLI::PositiveNumber)->capture_default_str();
  };
  add("--voxel", options.filter.voxel_m, "Voxels of the prefilter [m]");
  add("--keyframe-distance", options.odometry.keyframe_distance_m, "From one target scan to the next [m]");
  add("--keyframe-angle", options.odometry.keyframe_angle_rad, "From one target scan to the next [rad]");
  add("--gicp-reach", options.gicp.max_correspondence_m, "Farthest correspondence [m]");
  add("--gicp-epsilon", options.gicp.epsilon, "Change of the transform that ends GICP");
  add("--ndt-resolution", options.ndt.resolution_m, "Cells of NDT [m]");
  add("--ndt-epsilon", options.ndt.epsilon, "Change of the transform that ends NDT");
  add("--ndt-step", options.ndt.step_m, "Longest step of NDT's line search [m]");
}

void addBaseline(CLI::App& bench_command) {
  auto a = std::make_shared<BaselineArguments>();
  CLI::App* command = bench_command.add_subcommand(
      "baseline", "What PCL makes of a log, built as HDL-SLAM is: an OUT that `sgraphs eval` judges");
  command->add_option("log", a->options.log, "LCM log with SESSION and raw channels")->required();
  command->add_option("-o,--output", a->options.out_dir, "Folder for the result")->required();
  command
      ->add_option("--method", a->method,
                   "gicp or ndt: scan-to-keyframe odometry; graph: GICP with a pose graph; legs: the legs' "
                   "odometry alone")
      ->check(CLI::IsMember({"legs", "gicp", "ndt", "graph"}))
      ->capture_default_str();
  command->add_flag("--with-legs", a->options.with_legs,
                    "The legs' odometry as guess of gicp and ndt, and as odometry of the graph");
  addBaselineSettings(*command, a->options);
  command->footer("Example:\n  sgraphs bench baseline run.lcmlog -o OUT_GICP --method gicp");
  command->callback([a] { runBaselineCommand(*a); });
}

}  // namespace

void addBench(CLI::App& app) {
  CLI::App* command = app.add_subcommand("bench", "Measure accuracy, beside others on the same data");
  command->require_subcommand(1);
  command->footer("Example:\n  sgraphs bench accuracy --write-benchmark BENCHMARK.md");
  addAccuracy(*command);
  addBaseline(*command);
  CLI::App* speed = command->add_subcommand("speed", "Not in this version");
  speed->footer("Example:\n  sgraphs bench speed");
  speed->allow_extras();
  speed->callback([] { throw UsageError("bench speed: not in this version"); });
}

}  // namespace sgraphs::cli
