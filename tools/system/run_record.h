#pragma once

#include "backend/backend_node.h"
#include "backend/output/run_outputs.h"
#include "tools/system/system_config.h"

namespace sgraphs {

// What a finished backend knows of its run. `backend` must outlive the record.
RunRecord recordOf(const BackendNode& backend, const SystemConfig& config);

StageTiming timingOf(const LatencyHistogram& latency);

// Adds the messages that a process knows to be lost.
void addGaps(RunRecord& record, const InputGate& gate);

}  // namespace sgraphs
