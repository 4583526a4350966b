#pragma once

#include <map>
#include <optional>
#include <string>

#include "common/base/performance.h"
#include "common/bus/lcm_bus.h"
#include "sgraphs/run_result_t.hpp"
#include "tools/run/run_session.h"
#include "tools/run/status_board.h"
#include "tools/run/supervisor.h"
#include "tools/run/text_screen.h"
#include "tools/system/stop_signals.h"

namespace sgraphs {

// How a live run ended.
struct RunEnd {
  std::optional<run_result_t> result;  // as the backend said; none: it gave none
  int backend_code = 0;                // its exit code
  std::string backend_said;            // its last line
  std::string recording;               // file; empty: nothing was recorded
  int restarts = 0;
};

// `sgraphs run`: starts the processes (readers before writers), is the source of SESSION and STREAM_END,
// watches, restarts what ends before its time, and ends everything in order.
class LiveRun {
 public:
  // Makes the folders. SIGINT and SIGTERM must be blocked (blockStopSignals). Throws Error or UsageError if
  // something asked for cannot be had.
  explicit LiveRun(RunOptions options);

  // Until the sources come to an end, or SIGINT or SIGTERM asks for it; a second one ends at once.
  RunEnd run();

 private:
  void listen();
  void startListeners();
  void startRecorder();
  void watch();
  void endStream();
  void awaitBackend();
  void stopRest();
  void dispatch();
  // Dispatches until the condition holds; gives up after so many seconds, or if SIGINT comes.
  template <typename Condition>
  bool waitFor(double seconds, Condition condition);
  void publishSession();
  void everySecond();
  void failIfEnded(Supervisor::Role role);

  StopSignals stop_;
  RunOptions options_;
  LcmBus bus_;
  RunSession session_;
  std::string recording_;
  Supervisor supervisor_;
  StatusBoard board_;
  TextScreen screen_;
  Stopwatch since_start_, second_, since_session_, since_sources_;
  bool started_ = false;       // from now on what ends is started again
  bool session_open_ = false;  // the stream has not ended
  int stop_requests_ = 0;
  std::optional<run_result_t> result_;
};

}  // namespace sgraphs
