#pragma once

#include <string>
#include <vector>

#include "tools/bench/accuracy/run_result.h"
#include "tools/bench/accuracy/run_spec.h"

namespace sgraphs::bench {

// Where and how a benchmark was made; nothing in it names a folder of the machine.
struct BenchmarkOrigin {
  std::string command;  // as typed, the program as "sgraphs"
  std::string version;
  std::string commit;   // empty: not known
  std::string date;     // "2024-01-31"
  std::string machine;  // machineText()
};

// CPU, cores, memory, operating system of this machine, in one line.
std::string machineText();

// The section of BENCHMARK.md that `sgraphs bench accuracy` owns, with its two marks.
std::string accuracySection(const std::vector<TableSpec>& tables, const std::vector<RunResult>& results,
                            const BenchmarkOrigin& origin);

// BENCHMARK.md with that section in place of its old one, or behind what is there; `old_text` may be empty.
std::string withSection(const std::string& old_text, const std::string& section);

}  // namespace sgraphs::bench
