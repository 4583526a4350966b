#pragma once

#include <functional>
#include <string>

#include "tools/bench/baselines/keyframe_graph.h"
#include "tools/bench/baselines/point_filter.h"
#include "tools/bench/baselines/scan_odometry.h"
#include "tools/bench/baselines/scan_registration.h"

namespace sgraphs::bench {

// What to compare with.
enum class Baseline {
  kLegs,   // the legs' odometry alone
  kGicp,   // GICP scan-to-keyframe odometry
  kNdt,    // NDT scan-to-keyframe odometry
  kGraph,  // a pose graph with GICP loops over GICP odometry, or over the legs' where they take part
};

// "legs", "gicp", "ndt", "graph"; throws UsageError for another word.
Baseline parseBaseline(const std::string& text);

struct BaselineOptions {
  std::string log;
  std::string out_dir;
  Baseline baseline = Baseline::kGicp;
  PointFilterConfig filter;
  ScanOdometryConfig odometry;
  GicpConfig gicp;
  NdtConfig ndt;
  KeyframeGraphConfig graph;
  bool with_legs = false;  // gicp, ndt: as the guess of the next match; graph: as its odometry
  std::function<void(double sensor_s, double wall_s)> on_progress;  // after each scan; may be empty
};

struct BaselineReport {
  int64_t scans = 0;
  double duration_s = 0;  // of sensor time
  double wall_s = 0;      // of prefilter, registration and graph; decoding and the map not counted
  double scan_p50_ms = 0, scan_p99_ms = 0;
  int failed_matches = 0;
  int64_t keyframes = 0;  // of the graph
  int loops = 0;
};

// Writes OUT/trajectory.tum, odometry.tum, map.ply and summary.json, in the form of `replay`. The map holds
// every scan, placed by its pose. Single-threaded. Throws Error if the log holds no scan.
BaselineReport runBaseline(const BaselineOptions& options);

}  // namespace sgraphs::bench
