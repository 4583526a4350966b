#pragma once

#include <Eigen/Core>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "common/geometry/se3.h"

namespace sgraphs::simulate {

// Members of one JSON object, with errors that name file and item: "plan.json: walls[3].thickness …".
class PlanReader {
 public:
  // `where` names the file; `item` the object within it, empty for the top.
  PlanReader(const nlohmann::json& object, std::string where, std::string item);

  bool has(const char* key) const { return object_.contains(key); }
  // Refuses a key that is not among the known ones: all unknown ones, or (in objects to which other programs
  // may add) those that look like a slip of the pen.
  void allowOnly(const std::vector<std::string>& known) const;
  void refuseMisspelt(const std::vector<std::string>& known) const;

  double number(const char* key) const;
  double number(const char* key, double fallback, double min, double max) const;
  int integer(const char* key, int fallback) const;
  bool flag(const char* key, bool fallback) const;
  std::string text(const char* key, const std::string& fallback) const;
  Eigen::Vector2d xy(const char* key) const;
  Eigen::Vector3d xyz(const char* key) const;
  std::vector<double> numbers(const char* key, size_t count) const;  // count 0: any
  PlanReader object(const char* key) const;
  const nlohmann::json& array(const char* key) const;
  // Calls the function with a reader of each object of a list; a missing list is empty.
  void forEach(const char* key, const std::function<void(const PlanReader&)>& function) const;

  // {"xyz": […], "qxyzw": […]} or {"xyz": […], "rpy_deg": [roll, pitch, yaw]}.
  SE3 transform() const;

  // Throws Error about a key of this object.
  [[noreturn]] void fail(const std::string& key, const std::string& what) const;

 private:
  const nlohmann::json& at(const char* key) const;
  void refuse(const std::vector<std::string>& known, size_t max_distance) const;

  const nlohmann::json& object_;
  std::string where_;
  std::string item_;
};

}  // namespace sgraphs::simulate
