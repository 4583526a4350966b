// Time of backend rounds while a trajectory of 5000 keyframes is built: odometry to k-1, neighbour to k-2,
// and a loop every 100 keyframes.
#include <benchmark/benchmark.h>

#include <time.h>

#include <algorithm>
#include <random>

#include "backend/backend.h"

namespace sgraphs {
namespace {

constexpr int kPerCircle = 100;  // keyframes of one circle of 16 m radius

// CPU time of this thread: rounds are single-threaded, and other work on the machine must not count.
double cpuMilliseconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

SE3 truth(int k) {
  const double angle = 2.0 * M_PI * k / kPerCircle;
  return {Eigen::Quaterniond(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ())),
          {16.0 * std::sin(angle), 16.0 * (1.0 - std::cos(angle)), 0.002 * k}};
}

RelativePose measure(int from, int to, RelativePoseKind kind, std::mt19937& random) {
  std::normal_distribution<double> normal;
  Vector6d sigma;
  sigma << 0.01, 0.01, 0.01, 0.001, 0.001, 0.001;
  Vector6d noise;
  for (int i = 0; i < 6; ++i) noise(i) = sigma(i) * normal(random);
  RelativePose z;
  z.kind = kind;
  z.from = KeyframeId{from};
  z.to = KeyframeId{to};
  z.T_from_to = truth(from).inverse() * truth(to) * se3Exp(noise);
  z.covariance = sigma.cwiseAbs2().asDiagonal();
  return z;
}

std::vector<Keyframe> trajectory(int num_keyframes, bool with_up) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  std::vector<Keyframe> keyframes(static_cast<size_t>(num_keyframes));
  SE3 T_odom_body;
  for (int k = 0; k < num_keyframes; ++k) {
    Keyframe& keyframe = keyframes[static_cast<size_t>(k)];
    keyframe.id = KeyframeId{k};
    keyframe.time = Time{1000000LL * (k + 1)};
    if (k >= 1) {
      keyframe.relative_poses.push_back(measure(k - 1, k, RelativePoseKind::kOdometry, random));
      T_odom_body = T_odom_body * keyframe.relative_poses[0].T_from_to;
    }
    if (k >= 2) keyframe.relative_poses.push_back(measure(k - 2, k, RelativePoseKind::kNeighbour, random));
    if (k > kPerCircle && k % 100 == 0)
      keyframe.relative_poses.push_back(measure(k - kPerCircle, k, RelativePoseKind::kLoop, random));
    keyframe.T_odom_body = T_odom_body;
    if (!with_up) continue;
    const Eigen::Vector3d tilt(0.01 * normal(random), 0.01 * normal(random), 0);
    keyframe.up_body = truth(k).rotation.conjugate() * (so3Exp(tilt) * Eigen::Vector3d::UnitZ());
    keyframe.up_body.normalize();
    keyframe.up_sigma_rad = 0.01;
  }
  return keyframes;
}

double quantile(std::vector<double>& sorted, double q) {
  return sorted[static_cast<size_t>(q * static_cast<double>(sorted.size() - 1))];
}

void report(benchmark::State& state, const std::string& name, std::vector<double> ms) {
  std::sort(ms.begin(), ms.end());
  if (ms.empty()) return;
  state.counters[name + "_p50_ms"] = quantile(ms, 0.5);
  state.counters[name + "_p99_ms"] = quantile(ms, 0.99);
  state.counters[name + "_max_ms"] = ms.back();
}

void buildTrajectory(benchmark::State& state) {
  const int num_keyframes = static_cast<int>(state.range(0));
  const std::vector<Keyframe> keyframes = trajectory(num_keyframes, state.range(1) != 0);
  for (auto _ : state) {  // NOLINT(clang-analyzer-deadcode.DeadStores): the idiom of Google Benchmark
    Backend backend{BackendConfig{}};
    std::vector<double> all, last_thousand;
    int64_t round = 0, whole = 0;
    for (const Keyframe& keyframe : keyframes) {
      const double start = cpuMilliseconds();
      const RoundOutput output =
          backend.step({.round = round++, .time = keyframe.time, .keyframe = keyframe});
      const double elapsed = cpuMilliseconds() - start;
      whole += output.whole_graph;
      all.push_back(elapsed);
      if (round > num_keyframes - 1000) last_thousand.push_back(elapsed);
    }
    report(state, "all", all);
    report(state, "last1000", last_thousand);
    state.counters["whole_rounds"] = static_cast<double>(whole);
    state.counters["chi2_per_dof"] = [&] {
      double chi2 = 0, dof = -6.0 * (num_keyframes - 1);
      for (const auto& [kind, factors] : backend.factorStatistics()) {
        chi2 += factors.chi2;
        dof += static_cast<double>(factors.dof);
      }
      return chi2 / dof;
    }();
  }
}
BENCHMARK(buildTrajectory)
    ->ArgNames({"keyframes", "up"})
    ->Args({1000, 0})
    ->Args({1000, 1})
    ->Args({5000, 0})
    ->Args({5000, 1})
    ->Iterations(1)
    ->Unit(benchmark::kSecond);

}  // namespace
}  // namespace sgraphs

BENCHMARK_MAIN();
