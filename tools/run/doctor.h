#pragma once

#include <string>
#include <vector>

#include "tools/system/system_config.h"

namespace sgraphs {

// One thing that a live run needs of the machine.
struct Finding {
  enum class Level { kOk, kWarn, kFail };
  std::string name;  // "multicast route"
  Level level = Level::kOk;
  std::string found;  // what is there
  std::string mend;   // what to do about it; empty: nothing is to be done
  bool operator==(const Finding&) const = default;
};

struct DoctorOptions {
  std::string lcm_url;  // full
  std::string config_file;
  std::vector<std::string> assignments;
  std::string out_dir, record_dir;             // empty: not asked for
  std::string spot_host;                       // empty: no robot
  std::string programs_dir;                    // of our programs; empty: beside this one
  int data_port = 2368, position_port = 8308;  // of the LiDAR
  double sensor_patience_s = 2;
};

// Every check, in the order in which one would mend things.
std::vector<Finding> examine(const DoctorOptions& options);

// Single checks.
Finding checkConfig(const DoctorOptions& options);
Finding checkRoute(const std::string& lcm_url);
Finding checkTtl(const std::string& lcm_url);
Finding checkRoundTrip(const std::string& lcm_url);
Finding checkReceiveBuffer(const std::string& lcm_url, int64_t rmem_max);
Finding checkPort(const std::string& name, int port);
Finding checkSensor(int port, double patience_s);
Finding checkRobot(const std::string& host, int port = 443);
Finding checkProgram(const std::string& name, const std::string& program, Finding::Level if_absent,
                     const std::string& mend);
Finding checkFolder(const std::string& name, const std::string& folder);

// "ok    multicast route      lo" and, below, what to do.
std::string toText(const std::vector<Finding>& findings);
std::string toJson(const std::vector<Finding>& findings);
bool sound(const std::vector<Finding>& findings);  // nothing fails

// Parts of "udpm://ADDRESS:PORT?ttl=T&…"; other providers have none.
struct MulticastUrl {
  bool is_udpm = false;
  std::string address;
  int port = 0;
  int ttl = 0;
  int64_t recv_buf_size = 0;
};
MulticastUrl parseMulticastUrl(const std::string& url);

}  // namespace sgraphs
