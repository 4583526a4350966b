#pragma once

#include <string>

#include "tools/system/process.h"

namespace sgraphs {

// What the driver's command line asks for beside the configuration.
struct VelodyneDriverOptions {
  bool no_session = false;  // another program is the session's source
  // STREAM_END at the end: by default where this program is the session's source.
  bool stream_end = false, no_stream_end = false;
  std::string pcap;  // empty: the network
  double rate = 1;
  std::string epoch;       // "now" moves the capture's clock; empty keeps it
  double end_after_s = 0;  // 0: never
};

// Runs the driver until its source ends or it is stopped by a signal; the exit code.
int runVelodyneDriver(const ProcessText& text, const ProcessSetup& setup,
                      const VelodyneDriverOptions& options);

}  // namespace sgraphs
