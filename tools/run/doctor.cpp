#include "tools/run/doctor.h"

#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "common/base/error.h"
#include "tools/run/process_table.h"

namespace sgraphs {
namespace {

namespace fs = std::filesystem;
using Level = Finding::Level;

// Raw channels of an hour: 0.95 MB/s of packets and what surrounds them.
constexpr double kHour_GB = 3.6, kLeast_GB = 0.5;

const char* toString(Level level) {
  switch (level) {
    case Level::kOk:
      return "ok";
    case Level::kWarn:
      return "warn";
    case Level::kFail:
      break;
  }
  return "fail";
}

bool onPath(const std::string& program) {
  if (program.find('/') != std::string::npos) return access(program.c_str(), X_OK) == 0;
  const char* path = std::getenv("PATH");
  std::string folders = path ? path : "";
  for (size_t begin = 0; begin <= folders.size();) {
    const size_t end = std::min(folders.find(':', begin), folders.size());
    if (access((folders.substr(begin, end - begin) + "/" + program).c_str(), X_OK) == 0) return true;
    begin = end + 1;
  }
  return false;
}

std::vector<Finding> checkOurPrograms(const DoctorOptions& options) {
  RunOptions run;
  run.out_dir = "OUT";
  run.programs_dir = options.programs_dir;
  run.spot_host = options.spot_host;
  std::string absent;
  for (const ProcessRow& row : processTable(run, ""))
    if (!onPath(row.command.front())) absent += (absent.empty() ? "" : ", ") + row.command.front();
  if (absent.empty()) return {{"programs", Level::kOk, "all of sgraphs are there", ""}};
  return {{"programs", Level::kFail, "not there: " + absent, "build all targets, or `cmake --install` them"}};
}

// What lcm-spy needs to run.
Finding checkSpy() {
  std::string absent;
  if (!onPath("java")) absent = "java (default-jre)";
  for (const auto& [jar, package] : {std::pair{"/usr/share/java/lcm.jar", "liblcm-java"},
                                     std::pair{"/usr/share/java/jchart2d.jar", "libjchart2d-java"}})
    if (!fs::exists(jar)) absent += (absent.empty() ? "" : ", ") + std::string(jar) + " (" + package + ")";
  if (absent.empty()) return {"lcm-spy", Level::kOk, "java and its jars are there", ""};
  return {"lcm-spy", Level::kWarn, "not there: " + absent,
          "apt-get install default-jre liblcm-java libjchart2d-java; only `sgraphs spy` needs them"};
}

}  // namespace

std::vector<Finding> examine(const DoctorOptions& options) {
  std::vector<Finding> findings = checkOurPrograms(options);
  const auto add = [&findings](Finding finding) { findings.push_back(std::move(finding)); };
  add(checkConfig(options));
  add(checkRoute(options.lcm_url));
  add(checkTtl(options.lcm_url));
  add(checkRoundTrip(options.lcm_url));
  std::ifstream rmem("/proc/sys/net/core/rmem_max");
  int64_t rmem_max = 0;
  add(checkReceiveBuffer(options.lcm_url, rmem >> rmem_max ? rmem_max : 0));
  const std::string lcm = "apt-get install liblcm-bin";
  add(checkProgram("lcm-logger", "lcm-logger", Level::kFail, lcm + "; `sgraphs run --record` needs it"));
  add(checkProgram("lcm-logplayer", "lcm-logplayer", Level::kWarn, lcm + "; `sgraphs run --log` needs it"));
  add(checkSpy());
  const Finding data = checkPort("LiDAR port", options.data_port);
  add(data);
  add(checkPort("position port", options.position_port));
  if (data.level == Level::kOk)
    add(checkSensor(options.data_port, options.sensor_patience_s));
  else
    add({"LiDAR", Level::kWarn, "not looked for: its port is taken", data.mend});
  add(options.spot_host.empty() ? Finding{"robot", Level::kOk, "none is configured", ""}
                                : checkRobot(options.spot_host));
  if (!options.out_dir.empty()) add(checkFolder("output", options.out_dir));
  if (!options.record_dir.empty()) add(checkFolder("recordings", options.record_dir));
  return findings;
}

Finding checkConfig(const DoctorOptions& options) {
  const std::string name = "configuration";
  try {
    SystemConfig config;
    if (!options.config_file.empty()) loadConfigFile(visitOf(config), options.config_file);
    for (const std::string& assignment : options.assignments) setConfigValue(visitOf(config), assignment);
    return {name, Level::kOk, options.config_file.empty() ? "defaults" : options.config_file, ""};
  } catch (const Error& e) {
    return {name, Level::kFail, e.what(), "mend the key or the value it names"};
  }
}

Finding checkProgram(const std::string& name, const std::string& program, Level if_absent,
                     const std::string& mend) {
  if (onPath(program)) return {name, Level::kOk, "is there", ""};
  return {name, if_absent, "'" + program + "' is not on the PATH", mend};
}

Finding checkFolder(const std::string& name, const std::string& folder) {
  std::error_code failed;
  fs::path there = fs::absolute(folder, failed);
  while (!there.empty() && !fs::exists(there, failed) && there.has_relative_path())
    there = there.parent_path();
  if (!fs::is_directory(there, failed) || access(there.c_str(), W_OK | X_OK) != 0)
    return {name, Level::kFail, "'" + there.string() + "' is no folder that can be written to",
            "choose another one, or change its owner"};
  const fs::space_info space = fs::space(there, failed);
  const double free_GB = failed ? 0 : static_cast<double>(space.available) * 1e-9;
  char found[64];
  std::snprintf(found, sizeof found, "%.1f GB free", free_GB);
  if (free_GB < kLeast_GB) return {name, Level::kFail, found, "make room: an hour of raw channels is 3.6 GB"};
  if (free_GB < kHour_GB) return {name, Level::kWarn, found, "make room: an hour of raw channels is 3.6 GB"};
  return {name, Level::kOk, found, ""};
}

std::string toText(const std::vector<Finding>& findings) {
  std::string text;
  for (const Finding& f : findings) {
    char head[64];
    std::snprintf(head, sizeof head, "%-5s %-18s ", toString(f.level), f.name.c_str());
    text += head + f.found + "\n";
    if (!f.mend.empty()) text += std::string(25, ' ') + "-> " + f.mend + "\n";
  }
  return text;
}

std::string toJson(const std::vector<Finding>& findings) {
  nlohmann::ordered_json checks = nlohmann::ordered_json::array();
  for (const Finding& f : findings)
    checks.push_back({{"name", f.name}, {"level", toString(f.level)}, {"found", f.found}, {"mend", f.mend}});
  const nlohmann::ordered_json all{{"ok", sound(findings)}, {"checks", checks}};
  return all.dump(2) + "\n";
}

bool sound(const std::vector<Finding>& findings) {
  return std::none_of(findings.begin(), findings.end(),
                      [](const Finding& f) { return f.level == Level::kFail; });
}

}  // namespace sgraphs
