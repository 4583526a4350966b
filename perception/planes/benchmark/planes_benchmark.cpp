// CPU time of the segmentation per keyframe, over the keyframes of a walk through two rooms.
#include <benchmark/benchmark.h>
#include <time.h>

#include <algorithm>
#include <vector>

#include "perception/odometry/odometry.h"
#include "perception/planes/plane_segmentation.h"
#include "tools/simulate/scene/find_scene.h"
#include "tools/simulate/scene/scene_file.h"
#include "tools/simulate/scene/test_worlds.h"

namespace sgraphs {
namespace {

// Of this thread: the segmentation is single-threaded, and other work on the machine must not count.
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

void segmentKeyframes(benchmark::State& state) {
  const std::vector<Keyframe> keyframes = keyframesOf(simulate::loadScene(simulate::findScene("two_rooms")));
  const PlaneSegmentation segmentation;
  std::vector<double> ms;
  size_t planes = 0, points = 0;
  for (auto _ : state) {  // NOLINT(clang-analyzer-deadcode.DeadStores): the idiom of Google Benchmark
    for (const Keyframe& keyframe : keyframes) {
      const double start = cpuMilliseconds();
      planes += segmentation.step(keyframe).planes.size();
      ms.push_back(cpuMilliseconds() - start);
      points += keyframe.points.size();
    }
  }
  std::sort(ms.begin(), ms.end());
  state.counters["p50_ms"] = ms[ms.size() / 2];
  state.counters["p99_ms"] = ms[ms.size() * 99 / 100];
  state.counters["planes"] = static_cast<double>(planes) / static_cast<double>(ms.size());
  state.counters["points"] = static_cast<double>(points) / static_cast<double>(ms.size());
}
BENCHMARK(segmentKeyframes)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace sgraphs

BENCHMARK_MAIN();
