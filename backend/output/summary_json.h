#pragma once

#include <string>

#include "backend/output/run_outputs.h"

namespace sgraphs {

// summary.json of contract.md.
std::string summaryJson(const RunRecord& record);

}  // namespace sgraphs
