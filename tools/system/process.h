#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "common/bus/bus.h"
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
  double end_after_silence_s = 0;  // 0: silence is a state, not an end
};

struct ProcessText {
  std::string name, purpose, example;
  bool writes_output = false;
  bool stage = true;                                     // has the options of a stage
  std::function<void(CLI::App&)> add_options = nullptr;  // of this program alone
};

// Reads the command line and runs `body`; errors become one line on stderr and the contract's exit code.
int runProcess(const ProcessText& text, int argc, char** argv,
               const std::function<int(const ProcessSetup&)>& body);

// What the loop needs of a node.
struct LoopHooks {
  std::function<bool()> done;
  std::function<void()> publish_status;            // once a second
  std::function<void(const std::string&)> finish;  // ends the stream for this reason
  // The end is announced; it must follow within 30 s of the last message.
  std::function<bool()> overdue = [] { return false; };
  // What the node waits for before anything else can be done, as a number that changes with it; -1: nothing.
  // After 10 s of the same it is given up: the message was lost.
  std::function<int64_t()> awaited = [] { return int64_t{-1}; };
  std::function<void()> give_up_awaited = [] {};
};

// Dispatches until the node is done (with `stay`: until SIGINT or SIGTERM, which always stop it cleanly).
// Wall time decides only that nothing comes any more, and then the run is not reproducible.
void runLoop(Bus& bus, const ProcessSetup& setup, const LoopHooks& hooks);

// The end of a stage that another waits for: `repeat_end` sends its last message three times more, since a
// datagram may be lost. The exit code; why the run is not reproducible is said on stderr.
int leaveAfterEnd(const ProcessText& text, const std::function<void()>& repeat_end,
                  const std::string& why_not);

}  // namespace sgraphs
