#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace sgraphs {

// Lines for people about what recurs: each kind is said the 1st, 10th, 100th, … time, so that a fault that
// comes a thousand times a second fills no disk.
class Notices {
 public:
  void add(const std::string& kind, const std::string& text) {
    const int64_t count = ++counts_[kind];
    for (int64_t due = 1; due <= count; due *= 10)
      if (count == due) lines_.push_back(text + (count > 1 ? " (" + std::to_string(count) + " times)" : ""));
  }
  std::vector<std::string> take() { return std::exchange(lines_, {}); }

 private:
  std::map<std::string, int64_t> counts_;
  std::vector<std::string> lines_;
};

}  // namespace sgraphs
