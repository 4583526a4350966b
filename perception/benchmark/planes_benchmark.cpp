// CPU time of the segmentation per keyframe, over the keyframes of a walk through two rooms.
#include <vector>

#include "perception/benchmark/keyframe_times.h"
#include "perception/planes/plane_segmentation.h"

namespace sgraphs {
namespace {

void segmentKeyframes(benchmark::State& state) {
  const std::vector<Keyframe> keyframes = keyframesOfScene("two_rooms");
  const PlaneSegmentation segmentation;
  KeyframeTimes times;
  size_t planes = 0, points = 0;
  for (auto _ : state) {  // NOLINT(clang-analyzer-deadcode.DeadStores): the idiom of Google Benchmark
    for (const Keyframe& keyframe : keyframes) {
      times.add([&] { planes += segmentation.step(keyframe).planes.size(); });
      points += keyframe.points.size();
    }
  }
  times.report(state);
  state.counters["planes"] = static_cast<double>(planes) / times.count();
  state.counters["points"] = static_cast<double>(points) / times.count();
}
BENCHMARK(segmentKeyframes)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace sgraphs

BENCHMARK_MAIN();
