#include "tools/simulate/scene/plan_reader.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <utility>

#include "common/base/error.h"

namespace sgraphs::simulate {
namespace {

// Number of single-letter changes from a to b (Levenshtein).
size_t editDistance(const std::string& a, const std::string& b) {
  std::vector<size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), size_t{0});
  for (size_t i = 1; i <= a.size(); ++i) {
    size_t diagonal = row[0];
    row[0] = i;
    for (size_t j = 1; j <= b.size(); ++j) {
      const size_t change = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, change});
    }
  }
  return row.back();
}

}  // namespace

PlanReader::PlanReader(const nlohmann::json& object, std::string where, std::string item)
    : object_(object), where_(std::move(where)), item_(std::move(item)) {
  if (!object_.is_object())
    throw Error(where_ + ": " + (item_.empty() ? "the plan" : item_) + " must be an object {…}");
}

void PlanReader::fail(const std::string& key, const std::string& what) const {
  const std::string prefix = item_.empty() || key.empty() ? item_ : item_ + ".";
  throw Error(where_ + ": " + prefix + key + " " + what);
}

void PlanReader::refuse(const std::vector<std::string>& known, size_t max_distance) const {
  for (const auto& [key, value] : object_.items()) {
    if (std::find(known.begin(), known.end(), key) != known.end()) continue;
    // Who leaves out the unit means the key that goes on where his ends.
    const auto distance = [&k = key, max_distance](const std::string& candidate) {
      const size_t edits = editDistance(k, candidate);
      return edits > max_distance || !candidate.starts_with(k) ? edits : size_t{0};
    };
    const auto nearest =
        std::min_element(known.begin(), known.end(),
                         [&distance](const auto& a, const auto& b) { return distance(a) < distance(b); });
    if (distance(*nearest) <= max_distance)
      fail(key, "is not a key of a plan: did you mean '" + *nearest + "'?");
  }
}

void PlanReader::allowOnly(const std::vector<std::string>& known) const {
  refuse(known, std::numeric_limits<size_t>::max());
}

void PlanReader::refuseMisspelt(const std::vector<std::string>& known) const {
  refuse(known, 2);
}

const nlohmann::json& PlanReader::at(const char* key) const {
  const auto found = object_.find(key);
  if (found == object_.end()) fail(key, "is missing");
  return *found;
}

double PlanReader::number(const char* key) const {
  const auto& value = at(key);
  if (!value.is_number()) fail(key, "must be a number");
  return value.get<double>();
}

double PlanReader::number(const char* key, double fallback, double min, double max) const {
  if (!has(key)) return fallback;
  const double value = number(key);
  if (!(value >= min && value <= max)) {
    char range[96];
    std::snprintf(range, sizeof range, "is %g: it must lie between %g and %g", value, min, max);
    fail(key, range);
  }
  return value;
}

int PlanReader::integer(const char* key, int fallback) const {
  if (!has(key)) return fallback;
  if (!at(key).is_number_integer()) fail(key, "must be a whole number");
  return at(key).get<int>();
}

bool PlanReader::flag(const char* key, bool fallback) const {
  if (!has(key)) return fallback;
  if (!at(key).is_boolean()) fail(key, "must be true or false");
  return at(key).get<bool>();
}

std::string PlanReader::text(const char* key, const std::string& fallback) const {
  if (!has(key)) return fallback;
  if (!at(key).is_string()) fail(key, "must be a text in quotes");
  return at(key).get<std::string>();
}

std::vector<double> PlanReader::numbers(const char* key, size_t count) const {
  const auto& value = at(key);
  const bool right = value.is_array() && (count == 0 || value.size() == count) &&
                     std::all_of(value.begin(), value.end(), [](const auto& v) { return v.is_number(); });
  if (!right)
    fail(key, count == 0 ? "must be a list of numbers"
                         : "must be a list of " + std::to_string(count) + " numbers");
  return value.get<std::vector<double>>();
}

Eigen::Vector2d PlanReader::xy(const char* key) const {
  const auto v = numbers(key, 2);
  return {v[0], v[1]};
}

Eigen::Vector3d PlanReader::xyz(const char* key) const {
  const auto v = numbers(key, 3);
  return {v[0], v[1], v[2]};
}

PlanReader PlanReader::object(const char* key) const {
  return {at(key), where_, item_.empty() ? key : item_ + "." + key};
}

const nlohmann::json& PlanReader::array(const char* key) const {
  const auto& value = at(key);
  if (!value.is_array()) fail(key, "must be a list […]");
  return value;
}

void PlanReader::forEach(const char* key, const std::function<void(const PlanReader&)>& function) const {
  if (!has(key)) return;
  const auto& list = array(key);
  const std::string prefix = item_.empty() ? key : item_ + "." + key;
  for (size_t i = 0; i < list.size(); ++i)
    function(PlanReader(list[i], where_, prefix + "[" + std::to_string(i) + "]"));
}

SE3 PlanReader::transform() const {
  allowOnly({"xyz", "qxyzw", "rpy_deg"});
  SE3 T;
  T.translation = xyz("xyz");
  if (has("rpy_deg")) {
    const Eigen::Vector3d rpy = xyz("rpy_deg") * (std::numbers::pi / 180);
    T.rotation = Eigen::AngleAxisd(rpy.z(), Eigen::Vector3d::UnitZ()) *
                 Eigen::AngleAxisd(rpy.y(), Eigen::Vector3d::UnitY()) *
                 Eigen::AngleAxisd(rpy.x(), Eigen::Vector3d::UnitX());
  } else {
    const auto q = numbers("qxyzw", 4);
    T.rotation = Eigen::Quaterniond(q[3], q[0], q[1], q[2]);
    if (std::abs(T.rotation.norm() - 1.0) > 1e-3) fail("qxyzw", "must be a unit quaternion x, y, z, w");
    T.rotation.normalize();
  }
  return T;
}

}  // namespace sgraphs::simulate
