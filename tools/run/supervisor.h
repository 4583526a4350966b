#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/base/performance.h"
#include "tools/run/child.h"
#include "tools/run/process_table.h"
#include "tools/run/restart_policy.h"

namespace sgraphs {

// Starts the processes of a run, restarts what ends before its time, and ends them.
class Supervisor {
 public:
  // What they say goes to `log_dir`/<name>.txt.
  Supervisor(std::vector<ProcessRow> rows, std::string log_dir);

  using Role = ProcessRow::Role;
  // Throws Error if a program is not there.
  void start(Role role);
  // Restarts what has ended and should not have. Lines for people.
  std::vector<std::string> step();

  // No process of this role will be restarted any more; running ones get the signal.
  void stop(Role role, int signal);
  void kill(Role role);
  bool running(Role role);
  // Highest exit code of the processes of a role that have ended for good; nothing while one runs.
  std::optional<int> exitCode(Role role);

  // It has ended before stop() or a RUN_RESULT could be the reason, and is not started again.
  bool endedEarly(const std::string& name);
  pid_t pidOf(const std::string& name) { return states_[name].child ? states_[name].child->pid() : -1; }
  int restarts(const std::string& name) const;
  int restarts() const;
  const std::vector<ProcessRow>& rows() const { return rows_; }
  std::string outputOf(const std::string& name) const { return log_dir_ + "/" + name + ".txt"; }

 private:
  struct State {
    std::unique_ptr<Child> child;
    RestartPolicy policy;
    Stopwatch since;    // its start, or its end
    double wait_s = 0;  // before it is started again
    bool waits = false, wanted = false;
    int restarts = 0;
  };
  void launch(const ProcessRow& row, State& state);
  bool shouldRestart(const ProcessRow& row, int code) const;

  std::vector<ProcessRow> rows_;
  std::string log_dir_;
  std::map<std::string, State> states_;
};

}  // namespace sgraphs
