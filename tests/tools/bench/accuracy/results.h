#pragma once

#include <map>
#include <string>

#include "tools/bench/accuracy/run_result.h"

namespace sgraphs::bench {

inline RunResult resultOf(const std::string& scene, uint64_t seed, const std::string& run,
                          std::map<std::string, double> figures) {
  return {{scene, "digest of " + scene, seed, run, "", "0123456789abcdef"}, "", std::move(figures)};
}

}  // namespace sgraphs::bench
