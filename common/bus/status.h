#pragma once

#include <string>

#include "common/base/performance.h"
#include "common/bus/input_gate.h"
#include "common/bus/publisher.h"
#include "sgraphs/status_t.hpp"

namespace sgraphs {

// Health of a process: what it read and wrote, how long its steps take, how much memory it holds.
status_t makeStatus(const std::string& process, const std::string& state, const InputGate& gate,
                    const Publisher& publisher, size_t queue_depth, const LatencyHistogram& step);

}  // namespace sgraphs
