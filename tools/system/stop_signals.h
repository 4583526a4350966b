#pragma once

namespace sgraphs {

// Blocks SIGINT and SIGTERM for this thread and all that it starts. To be called before any other thread
// exists.
void blockStopSignals();

// SIGINT and SIGTERM, once blocked, as a question instead of an interruption.
class StopSignals {
 public:
  StopSignals();
  ~StopSignals();
  StopSignals(const StopSignals&) = delete;
  StopSignals& operator=(const StopSignals&) = delete;

  // One has come since the last call.
  bool requested();

 private:
  int file_ = -1;
};

}  // namespace sgraphs
