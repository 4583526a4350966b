#pragma once

#include <string>

#include "tools/system/process.h"

namespace sgraphs {

// What the command line of sgraphs-spot-bridge has beside the settings.
struct SpotBridgeOptions {
  std::string host, root_cert, credentials, frame;  // in place of the settings', where they are given
  bool own_session = false;
};

// Runs until a signal or the session's end; returns the exit code. Throws UsageError for what is missing,
// Error if the robot refuses the password.
int runSpotBridge(const ProcessText& text, const ProcessSetup& setup, const SpotBridgeOptions& options);

}  // namespace sgraphs
