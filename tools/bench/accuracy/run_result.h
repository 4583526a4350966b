#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

namespace sgraphs::bench {

// What decides the result of a run. Two runs with the same key give the same result, but for its times.
struct RunKey {
  std::string scene;         // as it was asked for
  std::string scene_digest;  // of its files
  uint64_t seed = 1;
  std::string run;       // id of RunSpec
  std::string settings;  // of --set, in order
  std::string program;   // digest of the executable

  bool operator==(const RunKey&) const = default;
};

// A finished run: figures by name, in SI units (run_result.cpp lists them). What was not judged is absent.
struct RunResult {
  RunKey key;
  std::string failed;  // why there are no figures; empty if there are
  std::map<std::string, double> figures;

  std::optional<double> figure(const std::string& name) const;
};

// Figures out of eval.json and summary.json of a run's OUT. Throws Error naming the file that cannot be read.
std::map<std::string, double> figuresOf(const std::string& out_dir);

std::string toJson(const RunResult& result);
// Throws Error if the text is no such result; `where` stands for the file.
RunResult resultFromJson(const std::string& text, const std::string& where);

}  // namespace sgraphs::bench
