#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "common/bus/journal_bus.h"
#include "tools/system/system_config.h"

namespace CLI {
class App;
}

namespace sgraphs {

// What a stage's process is started with.
struct ProcessSetup {
  std::string lcm_url;
  SystemConfig config;
  std::string odometry;            // override of SESSION's mode; empty: none
  std::string output_dir;          // empty: nothing is written
  bool stay = false;               // goes on publishing STATUS when done
  bool live = false;               // rounds have a deadline
  int64_t boot = 0;                // how often this process was restarted within the session
  std::string journal;             // file that it resumes from when it was killed; empty: it does not
  double end_after_silence_s = 0;  // 0: silence is a state, not an end
};

struct ProcessText {
  std::string name, purpose, example;
  bool writes_output = false;
  bool may_be_live = false;                              // has --live
  bool stage = true;                                     // has the options of a stage
  std::function<void(CLI::App&)> add_options = nullptr;  // of this program alone
};

// Reads the command line and runs `body`; errors become one line on stderr and the contract's exit code.
int runProcess(const ProcessText& text, int argc, char** argv,
               const std::function<int(const ProcessSetup&)>& body);

// What a node cannot go on without, and how long the clock lets it wait.
struct Awaited {
  std::function<int64_t()> number;  // changes with what is awaited; -1: nothing is
  std::function<double()> patience_s;
  std::function<void()> give_up;
  std::string said;  // when it is given up, behind the number; empty: nothing is said
};

// How long a message on its way may take; after that it was lost.
inline constexpr double kLostAfter_s = 10;

// What the loop needs of a node.
struct LoopHooks {
  std::function<bool()> done;
  std::function<void()> publish_status;            // once a second
  std::function<void(const std::string&)> finish;  // ends the stream for this reason
  // The end is announced; it must follow within 30 s of the last message.
  std::function<bool()> overdue = [] { return false; };
  std::vector<Awaited> awaited = {};
};

// Dispatches until the node is done (with `stay`: until SIGINT or SIGTERM, which always stop it cleanly).
// Wall time decides only that nothing comes any more, and then the run is not reproducible.
// A journal is read before, and removed after.
void runLoop(JournalBus& bus, const ProcessSetup& setup, const LoopHooks& hooks);

// The end of a stage that another waits for: `repeat_end` sends its last message three times more, since a
// datagram may be lost. The exit code; why the run is not reproducible is said on stderr.
int leaveAfterEnd(const ProcessText& text, const std::function<void()>& repeat_end,
                  const std::string& why_not);

}  // namespace sgraphs
