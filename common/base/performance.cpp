#include "common/base/performance.h"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace sgraphs {
namespace {

constexpr double kBinsPerOctave = 16;
constexpr size_t kBins = size_t{16} * 40;  // up to 2^40 us, twelve days

}  // namespace

int64_t Stopwatch::elapsedUs() const {
  return std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::steady_clock::now() - start_)
      .count();
}

LatencyHistogram::LatencyHistogram() : bins_(kBins, 0) {}

void LatencyHistogram::add(int64_t latency_us) {
  const double bin = kBinsPerOctave * std::log2(static_cast<double>(std::max<int64_t>(latency_us, 1)));
  ++bins_[std::min(static_cast<size_t>(std::ceil(bin)), kBins - 1)];
  ++count_;
}

int64_t LatencyHistogram::percentileUs(double share) const {
  if (count_ == 0) return 0;
  const auto wanted =
      std::clamp<int64_t>(std::llround(std::ceil(share * static_cast<double>(count_))), 1, count_);
  int64_t seen = 0;
  size_t bin = 0;
  while ((seen += bins_[bin]) < wanted) ++bin;
  return std::llround(std::exp2(static_cast<double>(bin) / kBinsPerOctave));
}

int64_t residentBytes() {
  long long pages_total = 0, pages_resident = 0;
  if (std::FILE* file = std::fopen("/proc/self/statm", "r")) {
    if (std::fscanf(file, "%lld %lld", &pages_total, &pages_resident) != 2) pages_resident = 0;
    std::fclose(file);
  }
  return pages_resident * sysconf(_SC_PAGESIZE);
}

double peakResidentMib() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;  // Linux reports KiB
}

}  // namespace sgraphs
