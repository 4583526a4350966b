#include "tools/bench/accuracy/accuracy_bench.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <filesystem>
#include <mutex>
#include <thread>

#include "common/base/error.h"
#include "common/base/performance.h"
#include "common/base/sha256.h"
#include "common/io/text_file.h"
#include "tools/bench/accuracy/child_process.h"
#include "tools/bench/accuracy/result_store.h"

namespace sgraphs::bench {
namespace {

namespace fs = std::filesystem;

// One recording and what runs on it.
struct Recording {
  std::string scene, scene_digest;
  uint64_t seed = 1;
  std::vector<std::string> runs;
};

std::string joined(const std::vector<std::string>& settings) {
  std::string text;
  for (const std::string& setting : settings) text += (text.empty() ? "" : " ") + setting;
  return text;
}

// Scenes in the tables' order, seeds within a scene.
std::vector<Recording> plan(const AccuracyOptions& options) {
  std::vector<Recording> scenes;
  for (const TableSpec& table : options.tables)
    for (const std::string& scene : table.scenes) {
      auto found =
          std::find_if(scenes.begin(), scenes.end(), [&](const auto& r) { return r.scene == scene; });
      if (found == scenes.end()) found = scenes.insert(scenes.end(), {scene, sceneDigest(scene), 1, {}});
      for (const std::string& run : runsOf(table))
        if (std::find(found->runs.begin(), found->runs.end(), run) == found->runs.end())
          found->runs.push_back(run);
    }
  std::vector<Recording> recordings;
  for (const Recording& scene : scenes)
    for (int i = 0; i < options.seeds; ++i) {
      recordings.push_back(scene);
      recordings.back().seed = options.first_seed + static_cast<uint64_t>(i);
    }
  return recordings;
}

class Bench {
 public:
  explicit Bench(const AccuracyOptions& options)
      : options_(options),
        store_(options.work_dir + "/results", options.any_program),
        program_digest_(sha256OfFile(options.program)),
        recordings_(plan(options)) {
    for (const Recording& recording : recordings_) progress_.total += recording.runs.size();
    results_.resize(recordings_.size());
  }

  std::vector<RunResult> run() {
    std::atomic<size_t> next{0};
    std::exception_ptr failure;
    const auto work = [&] {
      try {
        for (size_t i = next++; i < recordings_.size(); i = next++) results_[i] = workOff(recordings_[i], i);
      } catch (...) {
        const std::lock_guard lock(mutex_);
        if (!failure) failure = std::current_exception();
        next = recordings_.size();
      }
    };
    std::vector<std::thread> workers;
    for (int i = 1; i < options_.jobs; ++i) workers.emplace_back(work);
    work();
    for (std::thread& worker : workers) worker.join();
    if (failure) std::rethrow_exception(failure);
    std::vector<RunResult> all;
    for (auto& results : results_) all.insert(all.end(), results.begin(), results.end());
    return all;
  }

 private:
  std::vector<RunResult> workOff(const Recording& recording, size_t index) {
    const std::string folder = options_.work_dir + "/recording_" + std::to_string(index);
    std::string simulation_failed;
    bool simulated = false;
    std::vector<RunResult> results;
    for (const std::string& run : recording.runs) {
      const RunKey key{recording.scene,           recording.scene_digest, recording.seed, run,
                       joined(options_.settings), program_digest_};
      if (const auto known = options_.fresh ? std::nullopt : store_.find(key)) {
        results.push_back(*known);
        report(key, 0, /*known=*/true);
        continue;
      }
      if (options_.report_only) continue;
      const Stopwatch watch;
      if (!simulated) simulation_failed = simulateInto(folder, recording);
      simulated = true;
      RunResult result{key, simulation_failed, {}};
      if (simulation_failed.empty()) measure(folder, result);
      store_.save(result);
      report(key, watch.elapsedSeconds(), /*known=*/false);
      results.push_back(std::move(result));
    }
    if (simulated && !options_.keep) fs::remove_all(folder);
    return results;
  }

  std::string simulateInto(const std::string& folder, const Recording& recording) const {
    fs::remove_all(folder);
    createFolder(folder);
    return failureOf("simulate",
                     runChild({options_.program, "simulate", recording.scene, "-o", folder + "/run.lcmlog",
                               "--truth", folder + "/truth", "--with-odometry", "--seed",
                               std::to_string(recording.seed), "--threads", std::to_string(options_.threads)},
                              folder + "/simulate.txt"));
  }

  void measure(const std::string& folder, RunResult& result) const {
    const RunSpec spec = runSpec(result.key.run);
    const std::string out = folder + "/" + spec.id;
    const ChildResult ran = runChild(commandOf(spec, folder + "/run.lcmlog", out), out + ".txt");
    result.failed = failureOf(spec.id, ran);
    if (result.failed.empty())
      result.failed = failureOf(
          "eval", runChild({options_.program, "eval", out, "--truth", folder + "/truth"}, out + "_eval.txt"));
    if (!result.failed.empty()) return;
    result.figures = figuresOf(out);
    result.figures["cpu_s"] = ran.cpu_s;
    result.figures["peak_rss_mib"] = ran.peak_rss_mib;
    result.figures["jobs"] = options_.jobs;
    if (!options_.keep) fs::remove_all(out);
  }

  std::vector<std::string> commandOf(const RunSpec& spec, const std::string& log,
                                     const std::string& out) const {
    if (!spec.baseline.empty()) {
      std::vector<std::string> command{options_.program, "bench",      "baseline", log, "-o", out,
                                       "--method",       spec.baseline};
      if (spec.odometry == "encoder") command.push_back("--with-legs");
      return command;
    }
    std::vector<std::string> command{options_.program,
                                     "replay",
                                     log,
                                     "-o",
                                     out,
                                     "--odometry",
                                     spec.odometry,
                                     "--layers",
                                     spec.layers,
                                     "--threads",
                                     std::to_string(options_.threads)};
    for (const std::string& setting : options_.settings) command.insert(command.end(), {"--set", setting});
    return command;
  }

  static std::string failureOf(const std::string& what, const ChildResult& child) {
    // A run that another may not repeat bit by bit is still a measurement; `reproducible` tells.
    if (child.exit_code == kExitDone || child.exit_code == kExitNotReproducible) return "";
    return what + " ended with code " + std::to_string(child.exit_code) + ": " + child.last_line;
  }

  void report(const RunKey& key, double took_s, bool known) {
    const std::lock_guard lock(mutex_);
    ++progress_.finished;
    if (!known) {
      ++measured_;
      measured_s_ += took_s;
    }
    progress_.elapsed_s = watch_.elapsedSeconds();
    progress_.remaining_s = measured_ ? measured_s_ / static_cast<double>(measured_) *
                                            static_cast<double>(progress_.total - progress_.finished) /
                                            options_.jobs
                                      : -1;
    progress_.now =
        key.scene + ", seed " + std::to_string(key.seed) + ", " + key.run + (known ? " (from before)" : "");
    if (options_.on_progress) options_.on_progress(progress_);
  }

  const AccuracyOptions& options_;
  ResultStore store_;
  std::string program_digest_;
  std::vector<Recording> recordings_;
  std::vector<std::vector<RunResult>> results_;
  std::mutex mutex_;
  Stopwatch watch_;
  AccuracyProgress progress_;
  size_t measured_ = 0;
  double measured_s_ = 0;
};

}  // namespace

std::vector<RunResult> runAccuracy(const AccuracyOptions& options) {
  createFolder(options.work_dir);
  return Bench(options).run();
}

}  // namespace sgraphs::bench
