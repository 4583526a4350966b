#pragma once

#include <string>
#include <vector>

namespace sgraphs {

// A command as exec and posix_spawn take it: its words, then a null pointer. The words must outlive it.
inline std::vector<char*> execArguments(const std::vector<std::string>& words) {
  std::vector<char*> arguments;
  arguments.reserve(words.size() + 1);
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  return arguments;
}

}  // namespace sgraphs
