#pragma once

#include <chrono>
#include <cstdint>
#include <vector>

namespace sgraphs {

// The only place where wall time is read: it measures and reports, and no result depends on it.
class Stopwatch {
 public:
  Stopwatch() : start_(std::chrono::steady_clock::now()) {}
  int64_t elapsedUs() const;
  double elapsedSeconds() const { return static_cast<double>(elapsedUs()) * 1e-6; }
  void restart() { start_ = std::chrono::steady_clock::now(); }

 private:
  std::chrono::steady_clock::time_point start_;
};

// Distribution of step times in constant memory: bins grow by 2^(1/16), so a percentile is exact to 4.4 %.
class LatencyHistogram {
 public:
  LatencyHistogram();
  void add(int64_t latency_us);
  int64_t count() const { return count_; }
  // Smallest latency that at least this share (0 to 1) of the steps did not exceed; 0 without any step.
  int64_t percentileUs(double share) const;

 private:
  std::vector<int64_t> bins_;
  int64_t count_ = 0;
};

// Resident memory of this process: now, and its highest value so far.
int64_t residentBytes();
double peakResidentMib();

}  // namespace sgraphs
