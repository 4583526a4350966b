#pragma once

#include <benchmark/benchmark.h>
#include <time.h>

#include <algorithm>
#include <string>
#include <vector>

#include "common/types/keyframe.h"

namespace sgraphs {

// Keyframes of a simulated walk through a scene of config/scenes, by the LiDAR alone, seed 1.
std::vector<Keyframe> keyframesOfScene(const std::string& scene);

// CPU time per keyframe of this thread: the stages are single-threaded, and other work on the machine must
// not count.
class KeyframeTimes {
 public:
  template <typename Step>
  void add(Step step) {
    const double begin_ms = cpuMilliseconds();
    step();
    ms_.push_back(cpuMilliseconds() - begin_ms);
  }

  // Counters p50_ms and p99_ms.
  void report(benchmark::State& state) {
    if (ms_.empty()) return state.SkipWithError("no keyframe");
    std::sort(ms_.begin(), ms_.end());
    state.counters["p50_ms"] = ms_[ms_.size() / 2];
    state.counters["p99_ms"] = ms_[ms_.size() * 99 / 100];
  }
  double count() const { return static_cast<double>(ms_.size()); }

 private:
  static double cpuMilliseconds() {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
  }

  std::vector<double> ms_;
};

}  // namespace sgraphs
