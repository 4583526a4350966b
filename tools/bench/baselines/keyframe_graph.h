#pragma once

#include <memory>
#include <vector>

#include "tools/bench/baselines/pose_graph.h"
#include "tools/bench/baselines/scan_registration.h"

namespace sgraphs::bench {

// Chosen here for rooms, and stated in BENCHMARK.md: HDL-SLAM looks for loops within 15 m, outdoors.
struct KeyframeGraphConfig {
  double keyframe_distance_m = 1.0;
  double keyframe_angle_rad = 1.0;
  double loop_radius_m = 2.0;        // in the plane, between estimates
  double loop_min_path_m = 8.0;      // walked between the two ends of a loop
  double loop_min_interval_m = 5.0;  // walked since the last loop
  double loop_max_fitness_m2 = 0.1;
  double loop_reach_m = 2.0;  // of GICP's correspondences
  double fitness_range_m = 2.0;
};

// Keyframes in a pose graph, as HDL-SLAM builds it: edges along the odometry, and loops between keyframes
// near each other, found by their estimates, registered by GICP, judged by the fitness of the match. Every
// edge's covariance comes from its fitness. No floor, no GPS, no IMU.
class KeyframeGraph {
 public:
  explicit KeyframeGraph(const KeyframeGraphConfig& config = {});

  // The next scan and its odometry; returns the index of the keyframe it hangs on.
  size_t step(const SE3& T_odom_body, const Points& points_body);

  // Of every keyframe.
  const std::vector<SE3>& estimates() const { return T_map_body_; }
  SE3 odometryOf(size_t keyframe) const { return keyframes_[keyframe].T_odom_body; }
  int loops() const { return loops_; }

 private:
  struct Keyframe {
    SE3 T_odom_body;
    double path_m = 0;  // walked since the first one
    Points points;
  };

  void addKeyframe(const SE3& T_odom_body, const Points& points_body);
  void searchLoop();
  Matrix6d covarianceOf(double fitness_m2) const;

  KeyframeGraphConfig config_;
  std::unique_ptr<ScanRegistration> registration_;
  std::vector<Keyframe> keyframes_;
  std::vector<SE3> T_map_body_;
  std::vector<PoseEdge> edges_;
  double last_loop_path_m_;
  int loops_ = 0;
};

}  // namespace sgraphs::bench
