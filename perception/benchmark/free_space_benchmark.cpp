// CPU time of free space per keyframe, over the keyframes of a walk through a small office: evidence and
// clearance alone, and the whole stage.
#include <vector>

#include "perception/benchmark/keyframe_times.h"
#include "perception/free_space/free_space_evidence.h"
#include "perception/free_space/free_space_mapper.h"

namespace sgraphs {
namespace {

MapUpdate updateOf(const Keyframe& keyframe) {
  MapUpdate update;
  update.newest = keyframe.id;
  update.keyframes.push_back({keyframe.id, FloorId{0}, keyframe.time, keyframe.T_odom_body});
  return update;
}

template <typename Mapper>
void runKeyframes(benchmark::State& state) {
  const std::vector<Keyframe> keyframes = keyframesOfScene("small_office");
  KeyframeTimes times;
  for (auto _ : state) {  // NOLINT(clang-analyzer-deadcode.DeadStores): the idiom of Google Benchmark
    Mapper mapper{{}};
    for (const Keyframe& keyframe : keyframes)
      times.add([&] { benchmark::DoNotOptimize(mapper.step(keyframe, updateOf(keyframe))); });
  }
  times.report(state);
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
