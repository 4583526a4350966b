#include "tools/bench/baselines/run_baseline.h"

#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "common/base/error.h"
#include "common/base/performance.h"
#include "common/io/ply.h"
#include "common/io/text_file.h"
#include "common/io/tum.h"
#include "tools/bench/baselines/point_map.h"
#include "tools/bench/baselines/scan_source.h"

namespace sgraphs::bench {
namespace {

constexpr double kMapVoxel_m = 0.05;  // as our own map.ply
constexpr const char* kNames[] = {"legs", "gicp", "ndt", "graph"};

// A scan's pose, and the keyframe that it moves with.
struct ScanPose {
  Time time;
  SE3 T_odom_body;
  size_t keyframe = 0;
};

class Runner {
 public:
  explicit Runner(const BaselineOptions& options) : options_(options) {
    const bool legs_are_odometry =
        options.baseline == Baseline::kLegs || (options.baseline == Baseline::kGraph && options.with_legs);
    if (!legs_are_odometry)
      odometry_.emplace(options.baseline == Baseline::kNdt ? makeNdt(options.ndt) : makeGicp(options.gicp),
                        options.odometry);
    if (options.baseline == Baseline::kGraph) graph_.emplace(options.graph);
  }

  bool withLegs() const { return options_.with_legs || options_.baseline == Baseline::kLegs; }

  void step(const RecordedScan& recorded) {
    const Stopwatch watch;
    ScanPose pose{recorded.scan.end, recorded.T_odom_body.value_or(SE3{}), 0};
    if (options_.baseline != Baseline::kLegs) {
      const Points points = prefilter(recorded.scan, recorded.T_body_lidar, options_.filter);
      if (odometry_) pose.T_odom_body = odometry_->step(points, recorded.T_odom_body);
      if (graph_) pose.keyframe = graph_->step(pose.T_odom_body, points);
    }
    latency_.add(watch.elapsedUs());
    wall_s_ += watch.elapsedSeconds();
    poses_.push_back(pose);
    if (options_.on_progress)
      options_.on_progress((poses_.back().time - poses_.front().time).seconds(), wall_s_);
  }

  SE3 mapPose(size_t scan) const {
    const ScanPose& pose = poses_[scan];
    if (!graph_) return pose.T_odom_body;
    return graph_->estimates()[pose.keyframe] * graph_->odometryOf(pose.keyframe).inverse() *
           pose.T_odom_body;
  }

  void writeTrajectories() const {
    std::vector<StampedPose> optimised, odometry;
    for (size_t i = 0; i < poses_.size(); ++i) {
      optimised.push_back({poses_[i].time, mapPose(i)});
      odometry.push_back({poses_[i].time, poses_[i].T_odom_body});
    }
    writeTum(options_.out_dir + "/trajectory.tum", optimised);
    writeTum(options_.out_dir + "/odometry.tum", odometry);
  }

  void writeMap() const {
    PointMap map(kMapVoxel_m);
    size_t scan = 0;
    forEachScan(options_.log, withLegs(), [&](const RecordedScan& recorded) {
      const SE3 T_map_body = mapPose(scan++);
      for (const Eigen::Vector3f& p : pointsInBody(recorded.scan, recorded.T_body_lidar, options_.filter))
        map.add(T_map_body * p.cast<double>());
    });
    writePlyPoints(options_.out_dir + "/map.ply", {map.points(), {}});
  }

  BaselineReport report() const {
    BaselineReport report;
    report.scans = static_cast<int64_t>(poses_.size());
    report.duration_s = poses_.empty() ? 0 : (poses_.back().time - poses_.front().time).seconds();
    report.wall_s = wall_s_;
    report.scan_p50_ms = static_cast<double>(latency_.percentileUs(0.5)) * 1e-3;
    report.scan_p99_ms = static_cast<double>(latency_.percentileUs(0.99)) * 1e-3;
    if (odometry_) report.failed_matches = odometry_->failedMatches();
    if (graph_) report.keyframes = static_cast<int64_t>(graph_->estimates().size());
    if (graph_) report.loops = graph_->loops();
    return report;
  }

 private:
  const BaselineOptions& options_;
  std::optional<ScanOdometry> odometry_;
  std::optional<KeyframeGraph> graph_;
  std::vector<ScanPose> poses_;
  LatencyHistogram latency_;
  double wall_s_ = 0;
};

// The members that `replay` writes as well have its names.
std::string summaryOf(const BaselineOptions& options, const BaselineReport& report) {
  nlohmann::ordered_json json;
  json["baseline"] = kNames[static_cast<int>(options.baseline)];
  json["with_legs"] = options.with_legs;
  json["duration_s"] = report.duration_s;
  json["wall_s"] = report.wall_s;
  // The legs' odometry is only copied: no pace of its own.
  if (options.baseline != Baseline::kLegs)
    json["realtime_factor"] = report.wall_s > 0 ? report.duration_s / report.wall_s : 0.0;
  json["peak_rss_mib"] = peakResidentMib();
  json["stages"]["scan"] = {
      {"p50_ms", report.scan_p50_ms}, {"p99_ms", report.scan_p99_ms}, {"count", report.scans}};
  json["failed_matches"] = report.failed_matches;
  json["keyframes"] = report.keyframes;
  json["loops"] = report.loops;
  return json.dump(2) + "\n";
}

}  // namespace

Baseline parseBaseline(const std::string& text) {
  for (int i = 0; i < 4; ++i)
    if (text == kNames[i]) return static_cast<Baseline>(i);
  throw UsageError("no baseline '" + text + "': choose legs, gicp, ndt or graph");
}

BaselineReport runBaseline(const BaselineOptions& options) {
  Runner runner(options);
  forEachScan(options.log, runner.withLegs(), [&](const RecordedScan& scan) { runner.step(scan); });
  const BaselineReport report = runner.report();
  if (report.scans == 0)
    throw Error("log '" + options.log + "' gave no scan: check the recording with `sgraphs log info`");
  createFolder(options.out_dir);
  runner.writeTrajectories();
  runner.writeMap();
  writeFile(options.out_dir + "/summary.json", summaryOf(options, report));
  return report;
}

}  // namespace sgraphs::bench
