#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/bench/accuracy/run_result.h"

namespace sgraphs::bench {

// Of one figure over the seeds.
struct Spread {
  size_t count = 0;
  double median = 0;  // mean of the two in the middle for an even count
  double min = 0;
  double max = 0;
};

// None for no values.
std::optional<Spread> spreadOf(std::vector<double> values);

// A figure's spread over the runs of this scene and id that have it.
std::optional<Spread> spreadOf(const std::vector<RunResult>& results, const std::string& scene,
                               const std::string& run, const std::string& figure);

}  // namespace sgraphs::bench
