#pragma once

namespace sgraphs {

// SIGINT and SIGTERM as a question instead of an interruption.
class StopSignal {
 public:
  // Holds both back from now on: called before any other thread exists, so that all of them inherit it.
  static void block();

  StopSignal();
  ~StopSignal();
  StopSignal(const StopSignal&) = delete;
  StopSignal& operator=(const StopSignal&) = delete;

  // One of them came since the last question.
  bool requested();

 private:
  int file_ = -1;
};

}  // namespace sgraphs
