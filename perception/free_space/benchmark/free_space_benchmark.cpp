// CPU time of free space per keyframe, over the keyframes of a walk through an office.
#include <benchmark/benchmark.h>
#include <time.h>

#include <algorithm>
#include <string>
#include <vector>

#include "perception/free_space/free_space_mapper.h"
#include "perception/odometry/odometry.h"
#include "tools/simulate/scene/find_scene.h"
#include "tools/simulate/scene/scene_file.h"
#include "tools/simulate/scene/test_worlds.h"

namespace sgraphs {
namespace {

// Of this thread: the stage is single-threaded, and other work on the machine must not count.
double cpuMilliseconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

std::vector<Keyframe> keyframesOf(const simulate::Scene& scene) {
  const simulate::SimulatedWorld world(scene);
  const simulate::Trajectory truth = simulate::walkAlong(scene.path, scene.start, scene.floors_z_m.front());
  const simulate::SensorSimulator sensor(world.caster, truth, scene.T_body_lidar, scene.sensor, 1);
  Odometry odometry(OdometryConfig{}, OdometryMode::kLidar, scene.T_body_lidar);
  std::vector<Keyframe> keyframes;
  for (int64_t i = 0; i < sensor.numScans(); ++i)
    if (const auto output = odometry.step(sensor.scan(i), {}); output && output->keyframe)
      keyframes.push_back(*output->keyframe);
  return keyframes;
}

MapUpdate updateOf(const Keyframe& keyframe) {
  MapUpdate update;
  update.newest = keyframe.id;
  update.keyframes.push_back({keyframe.id, FloorId{0}, keyframe.time, keyframe.T_odom_body});
  return update;
}

// Runs `step` over all keyframes and reports its percentiles.
template <typename Mapper>
void runKeyframes(benchmark::State& state) {
  const std::vector<Keyframe> keyframes =
      keyframesOf(simulate::loadScene(simulate::findScene("small_office")));
  std::vector<double> ms;
  for (auto _ : state) {  // NOLINT(clang-analyzer-deadcode.DeadStores): the idiom of Google Benchmark
    Mapper mapper{{}};
    for (const Keyframe& keyframe : keyframes) {
      const double start = cpuMilliseconds();
      benchmark::DoNotOptimize(mapper.step(keyframe, updateOf(keyframe)));
      ms.push_back(cpuMilliseconds() - start);
    }
  }
  std::sort(ms.begin(), ms.end());
  state.counters["p50_ms"] = ms[ms.size() / 2];
  state.counters["p99_ms"] = ms[ms.size() * 99 / 100];
}

void evidenceAndClearance(benchmark::State& state) {
  runKeyframes<FreeSpaceEvidence>(state);
}
BENCHMARK(evidenceAndClearance)->Unit(benchmark::kMillisecond);

void wholeStage(benchmark::State& state) {
  runKeyframes<FreeSpaceMapper>(state);
}
BENCHMARK(wholeStage)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace sgraphs

BENCHMARK_MAIN();
