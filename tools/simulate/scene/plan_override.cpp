#include "tools/simulate/scene/plan_override.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <vector>

#include "common/base/error.h"

namespace sgraphs::simulate {
namespace {

using nlohmann::json;

// A plan may hold what other programs put there; an override of something that nobody reads is a mistake.
constexpr std::array kKeys{"T_body_lidar", "floors", "walls",  "doorways", "windows", "columns",
                           "stairs",       "people", "meshes", "rooms",    "boxes",   "slabs",
                           "start_utime",  "scene",  "sensor", "legs",     "faults",  "path"};

[[noreturn]] void fail(const std::string& assignment, const std::string& what) {
  throw UsageError("--set " + assignment + ": " + what);
}

std::vector<std::string> split(const std::string& key, const std::string& assignment) {
  std::vector<std::string> parts;
  for (size_t begin = 0; begin <= key.size();) {
    const size_t dot = std::min(key.find('.', begin), key.size());
    parts.push_back(key.substr(begin, dot - begin));
    if (parts.back().empty()) fail(assignment, "write key=value, such as path.speed_mps=0.5");
    begin = dot + 1;
  }
  return parts;
}

json& stepInto(json& at, const std::string& part, const std::string& above, const std::string& assignment) {
  if (at.is_null()) at = json::object();
  if (at.is_object()) return at[part];
  if (!at.is_array()) fail(assignment, "'" + above + "' is a single value and holds no '" + part + "'");
  size_t index = 0;
  const auto [end, failed] = std::from_chars(part.data(), part.data() + part.size(), index);
  if (failed != std::errc() || end != part.data() + part.size())
    fail(assignment, "'" + above + "' is a list: give a number from 0 instead of '" + part + "'");
  if (index >= at.size())
    fail(assignment, "'" + above + "' holds " + std::to_string(at.size()) + " items, numbered from 0");
  return at[index];
}

}  // namespace

void overridePlan(json& plan, const std::string& assignment) {
  const size_t equals = assignment.find('=');
  if (equals == std::string::npos) fail(assignment, "write key=value, such as path.speed_mps=0.5");
  const auto parts = split(assignment.substr(0, equals), assignment);
  if (std::find(kKeys.begin(), kKeys.end(), parts.front()) == kKeys.end())
    fail(assignment, "a plan has no '" + parts.front() + "' (config/scenes/README.md lists its keys)");
  json* at = &plan;
  std::string above = "the plan";
  for (const std::string& part : parts) {
    at = &stepInto(*at, part, above, assignment);
    above = above == "the plan" ? part : above + "." + part;
  }
  const std::string value = assignment.substr(equals + 1);
  json parsed = json::parse(value, nullptr, false);
  *at = parsed.is_discarded() ? json(value) : std::move(parsed);
}

}  // namespace sgraphs::simulate
