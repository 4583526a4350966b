#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "tools/simulate/sensor/fault_injector.h"

namespace sgraphs::simulate {

struct SimulateOptions {
  std::string scene;                   // as findScene takes it
  std::string output;                  // log to write
  std::string truth_dir;               // empty: none
  std::string waypoints;               // file with a walk: for a mesh, or instead of the plan's own
  std::vector<std::string> overrides;  // as overridePlan takes them
  uint64_t seed = 1;
  bool with_odometry = false;
  int num_threads = 1;
};

struct SimulateResult {
  double duration_s = 0;  // of sensor time
  double path_length_m = 0;
  int64_t packets = 0;  // in the log
  int64_t odometry_samples = 0;
  FaultCounts faults;
  std::string building;  // what was walked through, for people: "two_rooms", "mesh office, 5312 triangles"
  std::vector<std::string> warnings;
};

// Called now and then with the seconds done and the seconds in all.
using Progress = std::function<void(double done_s, double total_s)>;

// A building becomes a recorded log: SESSION, VELODYNE_PACKETS and, if asked for, SPOT_ODOMETRY; nothing in
// it knows the truth, which goes to truth_dir as gt.tum (T_building_body at 100 Hz), plan.json and mesh.ply.
// Of the legs' odometry the log follows the host: a sample stands where it arrived, whatever its own stamp.
// The log is the same, byte for byte, for the same scene and options at any number of threads. Throws Error
// or UsageError.
SimulateResult simulate(const SimulateOptions& options, const Progress& progress = {});

}  // namespace sgraphs::simulate
