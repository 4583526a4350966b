#pragma once

#include <string>

#include "tools/eval/evaluate.h"

namespace sgraphs {

// For people: a compact table in plain text.
std::string evaluationTable(const Evaluation& evaluation);

// For programs: eval.json, the same figures in SI units.
std::string evaluationJson(const Evaluation& evaluation);

}  // namespace sgraphs
