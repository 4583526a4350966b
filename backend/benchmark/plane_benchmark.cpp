// Time of the solver's rounds in a graph with planes: 1000 keyframes on laps of 250, 300 planes, 10 seen from
// each keyframe, among them a floor that is seen from everywhere.
#include <benchmark/benchmark.h>
#include <time.h>

#include <algorithm>

#include "tests/backend/solver/plane_world.h"

namespace sgraphs {
namespace {

// CPU time of this thread: rounds are single-threaded, and other work on the machine must not count.
double cpuMilliseconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

void report(benchmark::State& state, const std::string& name, std::vector<double> ms) {
  if (ms.empty()) return;
  std::sort(ms.begin(), ms.end());
  const auto quantile = [&](double q) {
    return ms[static_cast<size_t>(q * static_cast<double>(ms.size() - 1))];
  };
  state.counters[name + "_p50_ms"] = quantile(0.5);
  state.counters[name + "_p99_ms"] = quantile(0.99);
  state.counters[name + "_max_ms"] = ms.back();
}

void buildPlanes(benchmark::State& state) {
  testing_support::PlaneWorldOptions options;
  options.num_keyframes = static_cast<int>(state.range(0));
  options.per_lap = 250;
  options.num_planes = static_cast<int>(state.range(1));
  options.structure = state.range(2) != 0;
  const testing_support::PlaneWorld world = makePlaneWorld(options);
  for (auto _ : state) {  // NOLINT(clang-analyzer-deadcode.DeadStores): the idiom of Google Benchmark
    testing_support::PlaneRun run(world, {});
    std::vector<double> all, last;
    int whole = 0;
    for (int k = 0; k < options.num_keyframes; ++k) {
      const double start = cpuMilliseconds();
      run.addRound(k);
      whole += run.solver().solve(false).whole;
      all.push_back(cpuMilliseconds() - start);
      if (k >= options.num_keyframes - 250) last.push_back(all.back());
    }
    report(state, "all", all);
    report(state, "last250", last);
    state.counters["whole_rounds"] = whole;
    const testing_support::PlaneRun::Distance distance = run.distanceFromBatch();
    state.counters["off_mm"] = 1e3 * distance.m;
    state.counters["off_mrad"] = 1e3 * distance.rad;
    const double start = cpuMilliseconds();
    benchmark::DoNotOptimize(run.solver().poseCovariances());
    state.counters["all_covariances_ms"] = cpuMilliseconds() - start;
  }
}
BENCHMARK(buildPlanes)
    ->ArgNames({"keyframes", "planes", "structure"})
    ->Args({1000, 300, 0})
    ->Args({1000, 300, 1})
    ->Iterations(1)
    ->Unit(benchmark::kSecond);

}  // namespace
}  // namespace sgraphs

BENCHMARK_MAIN();
