#include "tools/bench/accuracy/statistics.h"

#include <algorithm>

namespace sgraphs::bench {

std::optional<Spread> spreadOf(std::vector<double> values) {
  if (values.empty()) return std::nullopt;
  std::sort(values.begin(), values.end());
  const size_t middle = values.size() / 2;
  const double median = values.size() % 2 ? values[middle] : (values[middle - 1] + values[middle]) / 2;
  return Spread{values.size(), median, values.front(), values.back()};
}

std::optional<Spread> spreadOf(const std::vector<RunResult>& results, const std::string& scene,
                               const std::string& run, const std::string& figure) {
  std::vector<double> values;
  for (const RunResult& result : results)
    if (result.key.scene == scene && result.key.run == run)
      if (const auto value = result.figure(figure)) values.push_back(*value);
  return spreadOf(std::move(values));
}

}  // namespace sgraphs::bench
