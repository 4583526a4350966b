#pragma once

#include <string>
#include <vector>

namespace sgraphs::bench {

struct ChildResult {
  int exit_code = 0;  // 128 + signal if one ended it
  double cpu_s = 0;
  double peak_rss_mib = 0;
  std::string last_line;  // of what it said
};

// Runs a program to its end; what it says goes to `output_file`. Throws Error if it cannot be started.
ChildResult runChild(const std::vector<std::string>& command, const std::string& output_file);

// Path of the running program.
std::string ownProgram();

}  // namespace sgraphs::bench
