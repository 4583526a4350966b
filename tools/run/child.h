#pragma once

#include <sys/types.h>

#include <optional>
#include <string>
#include <vector>

namespace sgraphs {

// A program started by this one. It stands in a process group of its own, so that Ctrl-C on the terminal
// reaches this program alone, and it ends when this program does, however that ends.
class Child {
 public:
  // What it says on stdout and stderr is appended to `output_file`. Throws Error if it cannot be started.
  Child(const std::vector<std::string>& command, const std::string& output_file);
  // Kills what still runs.
  ~Child();
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  // Exit code (128 + signal if one ended it), as soon as it has ended.
  std::optional<int> exitCode();
  void signal(int number);
  pid_t pid() const { return pid_; }

 private:
  pid_t pid_ = -1;
  std::optional<int> exit_code_;
};

// Last line that says anything in what a child said; empty: none.
std::string lastLineOf(const std::string& output_file);

}  // namespace sgraphs
