#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace sgraphs::simulate {

// Changes one item of a plan, as `--set path.speed_mps=0.5` and `--set walls.3.thickness=0.2` on the command
// line ask for. Keys are separated by dots; items of a list are numbered from 0. The value is JSON where it
// can be read as JSON, else a text. Objects that are missing on the way are made. Throws UsageError.
void overridePlan(nlohmann::json& plan, const std::string& assignment);

}  // namespace sgraphs::simulate
