#pragma once

#include <optional>
#include <string>

#include "tools/bench/accuracy/run_result.h"

namespace sgraphs::bench {

// Finished runs in a folder, one JSON file for each (scene, seed, run): what a run that was cut off goes on
// from.
class ResultStore {
 public:
  // any_program: results of other builds count, too.
  ResultStore(std::string folder, bool any_program);

  // The result of this very run; none if it is not there, failed, or was made of something else. Throws Error
  // if its file is there and cannot be read.
  std::optional<RunResult> find(const RunKey& key) const;
  // Whole or not at all: a run that is cut off leaves no half file.
  void save(const RunResult& result) const;

  std::string pathOf(const RunKey& key) const;

 private:
  std::string folder_;
  bool any_program_;
};

// Digest of a scene's plan and of the mesh files it names. Throws Error or UsageError if it cannot be read.
std::string sceneDigest(const std::string& scene);

}  // namespace sgraphs::bench
