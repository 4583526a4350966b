#pragma once

#include <cstdint>
#include <functional>
#include <string>

namespace sgraphs::simulate {

struct SimulateOptions {
  std::string scene;      // as findScene takes it
  std::string output;     // log to write
  std::string truth_dir;  // empty: none
  uint64_t seed = 1;
  bool with_odometry = false;
  int num_threads = 1;
};

struct SimulateResult {
  double duration_s = 0;  // of sensor time
  double path_length_m = 0;
  int64_t packets = 0;
  int64_t odometry_samples = 0;
};

// Called now and then with the seconds done and the seconds in all.
using Progress = std::function<void(double done_s, double total_s)>;

// A building becomes a recorded log: SESSION, VELODYNE_PACKETS and, if asked for, SPOT_ODOMETRY; nothing in
// it knows the truth, which goes to truth_dir as gt.tum (T_building_body at 100 Hz), plan.json and mesh.ply.
// The log is the same, byte for byte, for the same scene and options at any number of threads. Throws Error
// or UsageError.
SimulateResult simulate(const SimulateOptions& options, const Progress& progress = {});

}  // namespace sgraphs::simulate
