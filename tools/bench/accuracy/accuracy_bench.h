#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "tools/bench/accuracy/run_result.h"
#include "tools/bench/accuracy/run_spec.h"

namespace sgraphs::bench {

struct AccuracyProgress {
  size_t finished = 0;  // runs, those found from before included
  size_t total = 0;
  double elapsed_s = 0;
  double remaining_s = -1;  // as far as the runs so far tell; -1: not known
  std::string now;          // what has just been finished
};

struct AccuracyOptions {
  std::string work_dir;
  std::string program;  // the sgraphs executable that is measured
  std::vector<TableSpec> tables;
  int seeds = 3;
  uint64_t first_seed = 1;
  int jobs = 1;                                              // recordings worked on at once
  int threads = 2;                                           // of each program
  std::vector<std::string> settings;                         // --set of `sgraphs replay`
  bool fresh = false;                                        // results from before do not count
  bool any_program = false;                                  // results of other builds count
  bool report_only = false;                                  // nothing is measured
  bool keep = false;                                         // recordings and OUT folders stay
  std::function<void(const AccuracyProgress&)> on_progress;  // called by one thread at a time; may be empty
};

// Simulates every scene with every seed, runs what the tables ask for on the recordings, and judges it: each
// by its own process of `program`. Results stand in work_dir/results; those that are there already are not
// made again. A run that fails is a result that says why. Returns one result for each (scene, seed, run) of
// the tables; with `report_only` for those that stand there.
std::vector<RunResult> runAccuracy(const AccuracyOptions& options);

}  // namespace sgraphs::bench
