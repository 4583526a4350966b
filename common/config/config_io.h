#pragma once

#include <functional>
#include <limits>
#include <string>
#include <vector>

namespace sgraphs {

// A configuration is a plain struct with defaults and one method `void visit(ConfigVisitor&)` that lists its
// members once; loading, writing, range checks, documentation and the digest all follow from that list.
class ConfigVisitor {
 public:
  virtual ~ConfigVisitor() = default;
  // Names carry their unit (_m, _rad, _s, _hz); min and max are inclusive.
  virtual void field(const char* name, double& value, double min, double max, const char* doc) = 0;
  virtual void field(const char* name, int& value, int min, int max, const char* doc) = 0;
  virtual void field(const char* name, bool& value, const char* doc) = 0;
  virtual void field(const char* name, std::string& value, const std::vector<std::string>& allowed,
                     const char* doc) = 0;

  template <typename Config>
  void section(const char* name, Config& config, const char* doc) {
    enter(name, doc);
    config.visit(*this);
    leave();
  }

 protected:
  virtual void enter(const char* name, const char* doc) = 0;
  virtual void leave() = 0;
};

// The free functions below take any such struct by its visit method.
using ConfigVisit = std::function<void(ConfigVisitor&)>;

// Reads a YAML file over the defaults. Throws UsageError that names the file, the key and the nearest known
// key for an unknown one, or the range for a value outside it.
void loadConfigFile(const ConfigVisit& visit, const std::string& path);

// Applies "section.key=value". Throws UsageError likewise.
void setConfigValue(const ConfigVisit& visit, const std::string& assignment);

// The complete configuration as YAML, each key with its documentation as a comment.
std::string configToYaml(const ConfigVisit& visit);

// SHA-256 over all keys and values.
std::string configDigest(const ConfigVisit& visit);

template <typename Config>
ConfigVisit visitOf(Config& config) {
  return [&config](ConfigVisitor& v) { config.visit(v); };
}

}  // namespace sgraphs
