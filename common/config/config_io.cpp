#include "common/config/config_io.h"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <sstream>

#include "common/base/error.h"
#include "common/base/sha256.h"

namespace sgraphs {
namespace {

std::string shortest(double value) {
  std::array<char, 32> buffer{};
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value).ptr;
  return {buffer.data(), end};
}

size_t editDistance(const std::string& a, const std::string& b) {
  std::vector<size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), size_t{0});
  for (size_t i = 1; i <= a.size(); ++i) {
    size_t diagonal = std::exchange(row[0], i);
    for (size_t j = 1; j <= b.size(); ++j) {
      const size_t substitute = diagonal + (a[i - 1] != b[j - 1]);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, substitute});
    }
  }
  return row.back();
}

// Keeps the dotted path of the section being visited.
class PathVisitor : public ConfigVisitor {
 protected:
  void enter(const char* name, const char* /*doc*/) override { path_.emplace_back(name); }
  void leave() override { path_.pop_back(); }
  std::string key(const char* name) const {
    std::string key;
    for (const std::string& section : path_) key += section + ".";
    return key + name;
  }
  std::vector<std::string> path_;
};

// Takes values from a map of dotted keys to texts, and remembers which keys exist.
class Assigner : public PathVisitor {
 public:
  Assigner(std::map<std::string, std::string> values, std::string source)
      : values_(std::move(values)), source_(std::move(source)) {}

  void field(const char* name, double& value, double min, double max, const char* /*doc*/) override {
    const auto text = take(name);
    if (!text) return;
    value = number<double>(name, *text);
    if (!(value >= min && value <= max))
      fail(name, *text, "must lie in [" + shortest(min) + ", " + shortest(max) + "]");
  }
  void field(const char* name, int& value, int min, int max, const char* /*doc*/) override {
    const auto text = take(name);
    if (!text) return;
    value = number<int>(name, *text);
    if (value < min || value > max)
      fail(name, *text, "must lie in [" + std::to_string(min) + ", " + std::to_string(max) + "]");
  }
  void field(const char* name, bool& value, const char* /*doc*/) override {
    const auto text = take(name);
    if (!text) return;
    if (*text != "true" && *text != "false") fail(name, *text, "must be true or false");
    value = *text == "true";
  }
  void field(const char* name, std::string& value, const std::vector<std::string>& allowed,
             const char* /*doc*/) override {
    const auto text = take(name);
    if (!text) return;
    if (!allowed.empty() && std::find(allowed.begin(), allowed.end(), *text) == allowed.end()) {
      std::string list;
      for (const std::string& word : allowed) list += (list.empty() ? "" : ", ") + word;
      fail(name, *text, "must be one of " + list);
    }
    value = *text;
  }

  // Throws for the first key that no field took.
  void rejectUnknown() const {
    if (values_.empty()) return;
    const std::string& unknown = values_.begin()->first;
    const auto nearest = std::min_element(known_.begin(), known_.end(), [&](const auto& a, const auto& b) {
      return editDistance(a, unknown) < editDistance(b, unknown);
    });
    throw UsageError(source_ + ": unknown key '" + unknown + "'" +
                     (nearest == known_.end() ? "" : "; the nearest known key is '" + *nearest + "'"));
  }

 private:
  std::optional<std::string> take(const char* name) {
    const std::string full = key(name);
    known_.push_back(full);
    const auto found = values_.find(full);
    if (found == values_.end()) return std::nullopt;
    std::string text = found->second;
    values_.erase(found);
    return text;
  }
  template <typename T>
  T number(const char* name, const std::string& text) const {
    T value{};
    const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
    if (result.ec != std::errc() || result.ptr != text.data() + text.size())
      fail(name, text, "is not a number");
    return value;
  }
  [[noreturn]] void fail(const char* name, const std::string& text, const std::string& why) const {
    throw UsageError(source_ + ": '" + key(name) + "' = '" + text + "' " + why);
  }

  std::map<std::string, std::string> values_;
  std::string source_;
  std::vector<std::string> known_;
};

class Writer : public PathVisitor {
 public:
  void field(const char* name, double& value, double min, double max, const char* doc) override {
    line(name, shortest(value), std::string(doc) + "; " + shortest(min) + " to " + shortest(max));
  }
  void field(const char* name, int& value, int min, int max, const char* doc) override {
    line(name, std::to_string(value),
         std::string(doc) + "; " + std::to_string(min) + " to " + std::to_string(max));
  }
  void field(const char* name, bool& value, const char* doc) override {
    line(name, value ? "true" : "false", doc);
  }
  void field(const char* name, std::string& value, const std::vector<std::string>& allowed,
             const char* doc) override {
    std::string text = doc;
    for (size_t i = 0; i < allowed.size(); ++i) text += (i ? ", " : "; one of ") + allowed[i];
    line(name, "\"" + value + "\"", text);
  }
  std::string text() const { return out_.str(); }
  const std::map<std::string, std::string>& values() const { return values_; }

 protected:
  void enter(const char* name, const char* doc) override {
    out_ << indent() << "# " << doc << "\n" << indent() << name << ":\n";
    PathVisitor::enter(name, doc);
  }

 private:
  std::string indent() const { return std::string(2 * path_.size(), ' '); }
  void line(const char* name, const std::string& value, const std::string& doc) {
    out_ << indent() << "# " << doc << "\n" << indent() << name << ": " << value << "\n";
    values_[key(name)] = value;
  }
  std::ostringstream out_;
  std::map<std::string, std::string> values_;
};

void flatten(const YAML::Node& node, const std::string& prefix, const std::string& path,
             std::map<std::string, std::string>& values) {
  for (const auto& entry : node) {
    const std::string key = prefix + entry.first.Scalar();
    if (entry.second.IsMap())
      flatten(entry.second, key + ".", path, values);
    else if (entry.second.IsScalar())
      values[key] = entry.second.Scalar();
    else if (!entry.second.IsNull())
      throw UsageError(path + ": '" + key + "' must be a single value or a section");
  }
}

}  // namespace

void loadConfigFile(const ConfigVisit& visit, const std::string& path) {
  std::map<std::string, std::string> values;
  try {
    const YAML::Node root = YAML::LoadFile(path);
    if (root.IsMap())
      flatten(root, "", path, values);
    else if (!root.IsNull())
      throw UsageError(path + ": a configuration is a YAML mapping of sections; this file is not");
  } catch (const YAML::BadFile&) {
    throw UsageError("cannot read configuration '" + path + "': check the path");
  } catch (const YAML::Exception& e) {
    throw UsageError(path + ": line " + std::to_string(e.mark.line + 1) + ": " + e.msg);
  }
  Assigner assigner(std::move(values), path);
  visit(assigner);
  assigner.rejectUnknown();
}

void setConfigValue(const ConfigVisit& visit, const std::string& assignment) {
  const size_t equals = assignment.find('=');
  if (equals == std::string::npos || equals == 0)
    throw UsageError("--set '" + assignment + "': write section.key=value");
  Assigner assigner({{assignment.substr(0, equals), assignment.substr(equals + 1)}}, "--set");
  visit(assigner);
  assigner.rejectUnknown();
}

std::string configToYaml(const ConfigVisit& visit) {
  Writer writer;
  visit(writer);
  return writer.text();
}

std::string configDigest(const ConfigVisit& visit) {
  Writer writer;
  visit(writer);
  Sha256 sha;
  for (const auto& [key, value] : writer.values()) {
    sha.add(key);
    sha.add(value);
  }
  return sha.hex();
}

}  // namespace sgraphs
