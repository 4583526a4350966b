#pragma once

namespace sgraphs {

// The program sgraphs-spot-bridge: reads the command line and runs until a signal, the session's end, or an
// error, which becomes one line on stderr. Returns the exit code.
int runSpotBridge(int argc, char** argv);

}  // namespace sgraphs
