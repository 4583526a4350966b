#pragma once

#include <stdexcept>
#include <string>

namespace sgraphs {

// What a user can mend: the text is one line that says what is wrong, with which file, key or message, and
// what to do. Broken assumptions of the program itself are std::logic_error.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// A wrong command line or configuration: exit code 2 where Error is exit code 1.
class UsageError : public Error {
 public:
  using Error::Error;
};

// Exit codes of every program (contract.md).
inline constexpr int kExitDone = 0;
inline constexpr int kExitFailed = 1;
inline constexpr int kExitUsage = 2;
inline constexpr int kExitNotReproducible = 3;

}  // namespace sgraphs
