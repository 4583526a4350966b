#pragma once

#include <cstddef>
#include <cstdio>
#include <optional>
#include <string>

namespace sgraphs::spy {

struct TextSpyOptions {
  std::string url;      // any LCM URL; empty: LCM's default; file://LOG: a log, read as fast as it goes
  std::string channel;  // print its messages in place of the table; empty: the table
  bool once = false;    // one table, or one message, and out
  std::optional<double> duration_s;
  size_t max_elements = 8;  // of an array that is printed
};

// Watches a bus until the time is over (without one: until the program is stopped), or a log to its end.
// Throws Error if nothing was to be heard.
void runTextSpy(const TextSpyOptions& options, std::FILE* out);

}  // namespace sgraphs::spy
