#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "backend/backend.h"
#include "backend/graph/situational_graph.h"
#include "backend/output/session_clock.h"
#include "common/types/keyframe.h"

namespace sgraphs {

// Latency of one stage over a run.
struct StageTiming {
  double p50_ms = 0;
  double p99_ms = 0;
  double max_ms = 0;
  int64_t count = 0;
};

// What a run leaves behind; `graph` must outlive the record.
struct RunRecord {
  const SituationalGraph* graph = nullptr;
  std::vector<OdometryEstimate> scans;  // every scan of this run, in order of time
  std::map<std::string, FactorStatistics> factors;
  std::map<KeyframeId, Matrix6d> keyframe_covariances;  // of T_map_body, tangent of body; may hold a part

  // Facts for summary.json. Wall times and memory are the only ones that may differ between two replays.
  std::string version;
  std::string config_digest;
  std::string input_digest;
  std::string graph_digest;
  bool reproducible = true;
  std::string why_not;  // empty if reproducible
  double duration_s = 0;
  double wall_s = 0;
  double realtime_factor = 0;
  double peak_rss_mib = 0;
  std::map<std::string, StageTiming> stages;
  std::map<std::string, int64_t> gaps;  // messages lost per channel
  // The legs' clock against the LiDAR's, as far as it was estimated here.
  struct LegsClock {
    double offset_ms = 0, sigma_ms = 0, in_force_ms = 0;
  };
  std::optional<LegsClock> legs_clock;

  // Where the map of an earlier run was continued: stamps of scans and keyframes are then by the map's clock,
  // and poses in odom in that of the map.
  struct Continued {
    std::string graph_digest;            // of the earlier run, as its summary says
    bool same = true;                    // the loaded map has it
    int64_t keyframes = 0;               // loaded
    double load_s = 0;                   // wall time
    double walked_m = 0;                 // by the robot, until it was found
    double after_s = 0;                  // sensor time, likewise
    int64_t looks = 0;                   // that prove it
    KeyframeId matched;                  // keyframe of the map beside which it was found
    SE3 T_mapodom_odom;                  // this run's own odom in that of the map
    std::vector<SessionClock> sessions;  // all, this run's last
  };
  std::optional<Continued> continued;
};

// Writes every file of OUT (contract.md): trajectory.tum, keyframes.tum,
// odometry.tum, map.ply, graph.json, graph.g2o, floorplan_f*.svg and .png, occupancy_f*.pgm and .yaml,
// summary.json. Creates the folder. The same graph and scans give the same bytes, summary.json's wall times
// excepted. Throws Error naming the file that cannot be written; a run without a keyframe writes what there
// is (an empty map and no plans).
void writeOutputs(const RunRecord& record, const std::string& out_dir);

}  // namespace sgraphs
