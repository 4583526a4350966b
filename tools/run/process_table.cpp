#include "tools/run/process_table.h"

#include <unistd.h>

#include <filesystem>

#include "common/bus/channels.h"
#include "common/bus/lcm_bus.h"

namespace sgraphs {
namespace {

namespace fs = std::filesystem;
using Role = ProcessRow::Role;

// A program of ours: beside this one, else wherever the PATH finds it.
std::string pathOf(const std::string& program, const RunOptions& options) {
  std::error_code none;
  const fs::path folder = options.programs_dir.empty()
                              ? fs::read_symlink("/proc/self/exe", none).parent_path()
                              : fs::path(options.programs_dir);
  const fs::path beside = folder / program;
  return fs::exists(beside, none) ? beside.string() : program;
}

class Table {
 public:
  explicit Table(const RunOptions& options) : options_(options) {}

  // A program of ours with the options that all of them have.
  void add(const std::string& stage, const std::string& status, Role role,
           const std::vector<std::string>& arguments = {}, const std::string& program = "") {
    ProcessRow row{program.empty() ? stage : program, stage, status, role, {}};
    row.command = {pathOf("sgraphs-" + row.name, options_)};
    append(row, {"--lcm-url", options_.lcm_url});
    if (!options_.config_file.empty()) append(row, {"--config", options_.config_file});
    for (const std::string& assignment : options_.assignments) append(row, {"--set", assignment});
    if (role == Role::kBackend || role == Role::kStage)
      append(row, {"--state-dir", options_.out_dir + "/state"});
    append(row, arguments);
    rows_.push_back(std::move(row));
  }
  // A program of LCM's.
  void add(const std::string& name, Role role, const std::vector<std::string>& command) {
    rows_.push_back({name, "", "", role, command});
  }
  std::vector<ProcessRow> rows() { return std::move(rows_); }

 private:
  static void append(ProcessRow& row, const std::vector<std::string>& words) {
    row.command.insert(row.command.end(), words.begin(), words.end());
  }
  const RunOptions& options_;
  std::vector<ProcessRow> rows_;
};

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", value);
  return text;
}

void addSources(Table& table, const RunOptions& options) {
  if (!options.log.empty())
    return table.add("player", Role::kPlayer,
                     {"lcm-logplayer", "-s", number(options.rate), "-e",
                      "VELODYNE_PACKETS|LIDAR_POINTS|SPOT_ODOMETRY", "-l", options.lcm_url, options.log});
  std::vector<std::string> driver{"--no-session"};
  if (!options.pcap.empty())
    driver.insert(driver.end(), {"--pcap", options.pcap, "--rate", number(options.rate), "--epoch", "now"});
  table.add("", "STATUS_VELODYNE_DRIVER", options.pcap.empty() ? Role::kSource : Role::kPlayer, driver,
            "velodyne-driver");
  if (options.pcap.empty() && !options.spot_host.empty())
    table.add("", "STATUS_SPOT_BRIDGE", Role::kSource, {"--host", options.spot_host}, "spot-bridge");
}

}  // namespace

std::string rawChannelsPattern() {
  std::string pattern;
  for (const channels::Row& row : channels::table())
    if (row.raw) pattern += (pattern.empty() ? "" : "|") + std::string(row.name);
  return pattern;
}

std::vector<ProcessRow> processTable(const RunOptions& options, const std::string& recording) {
  Table table(options);
  table.add("backend", channels::kStatusBackend.name, Role::kBackend, {"--live", "-o", options.out_dir});
  table.add("rooms", channels::kStatusRooms.name, Role::kStage);
  table.add("free-space", channels::kStatusFreeSpace.name, Role::kStage);
  table.add("loops", channels::kStatusLoops.name, Role::kStage);
  table.add("planes", channels::kStatusPlanes.name, Role::kStage);
  table.add("odometry", channels::kStatusOdometry.name, Role::kStage);
  // The self test's channel is recorded as well: it tells that the recorder has begun to listen.
  const std::string recorded = options.record_all ? ".*" : rawChannelsPattern() + "|LCM_SELF_TEST";
  if (!recording.empty())
    table.add("recorder", Role::kRecorder,
              {"lcm-logger", "-q", "-f", "-c", recorded, "--lcm-url=" + options.lcm_url, recording});
  addSources(table, options);
  return table.rows();
}

}  // namespace sgraphs
