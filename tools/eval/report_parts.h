#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "tools/eval/trajectory_error.h"

// What the pieces of the report share; for tools/eval alone.
namespace sgraphs::report {

using Json = nlohmann::ordered_json;

__attribute__((format(printf, 1, 2))) std::string format(const char* pattern, ...);

Json statisticsJson(const ErrorStatistics& statistics);

}  // namespace sgraphs::report
