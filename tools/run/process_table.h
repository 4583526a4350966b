#pragma once

#include <string>
#include <vector>

#include "tools/system/system_config.h"

namespace sgraphs {

struct RunOptions {
  std::string out_dir;
  std::string record_dir;  // raw channels are recorded there; empty: nowhere
  bool record_all = false;
  std::string pcap, log;     // in place of a sensor and a robot; empty: those
  double rate = 1;           // of pcap and log
  std::string spot_host;     // a Spot's address; empty: the configuration's, or none
  std::string T_body_lidar;  // of a live sensor; empty: the configuration's
  std::string odometry;      // mode; empty: fused if there is a robot or a log with odometry, else lidar
  std::string lcm_url;
  std::string config_file;
  std::vector<std::string> assignments;
  std::string programs_dir;  // where the programs are; empty: beside this one, then the PATH
  SystemConfig config;       // what config_file and assignments come to
};

// One process of a run.
struct ProcessRow {
  enum class Role {
    kBackend,   // its end is the run's
    kStage,     // ends with RUN_RESULT; restarted if it ends before
    kSource,    // stopped first; restarted if it fails
    kPlayer,    // a source that comes to an end: so does the run
    kRecorder,  // stopped last
  };
  std::string name;
  std::string stage;           // as SESSION names it; empty: none
  std::string status_channel;  // empty: it reports nothing
  Role role = Role::kStage;
  std::vector<std::string> command;
};

// The processes of a run in the order in which they are started: readers before writers. `recording`: file of
// the recorder; empty: no recorder.
std::vector<ProcessRow> processTable(const RunOptions& options, const std::string& recording);

// What lcm-logger and lcm-logplayer are told of the channels that make a log complete.
std::string rawChannelsPattern();

}  // namespace sgraphs
