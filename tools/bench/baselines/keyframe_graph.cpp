#include "tools/bench/baselines/keyframe_graph.h"

#include <algorithm>
#include <cmath>

#include "tools/bench/baselines/scan_odometry.h"

namespace sgraphs::bench {
namespace {

// HDL-SLAM's rule from fitness to standard deviations, with the ranges of S-Graphs' settings of 2022.
constexpr double kFitnessGain = 20.0;
constexpr double kFullFitness_m2 = 0.5;
constexpr double kMinSigma_m = 0.1, kMaxSigma_m = 5.0;
// Of the quaternion's vector part there, which is half an angle.
constexpr double kMinSigma_rad = 2 * 0.1, kMaxSigma_rad = 2 * 0.4;

double between(double min_sigma, double max_sigma, double share) {
  return min_sigma * min_sigma + (max_sigma * max_sigma - min_sigma * min_sigma) * share;
}

GicpConfig loopGicp(const KeyframeGraphConfig& config) {
  GicpConfig gicp;
  gicp.max_correspondence_m = config.loop_reach_m;
  return gicp;
}

}  // namespace

KeyframeGraph::KeyframeGraph(const KeyframeGraphConfig& config)
    : config_(config),
      registration_(makeGicp(loopGicp(config))),
      last_loop_path_m_(-config.loop_min_interval_m) {}

size_t KeyframeGraph::step(const SE3& T_odom_body, const Points& points_body) {
  if (keyframes_.empty() || farFrom(keyframes_.back().T_odom_body, T_odom_body, config_.keyframe_distance_m,
                                    config_.keyframe_angle_rad)) {
    addKeyframe(T_odom_body, points_body);
    searchLoop();
  }
  return keyframes_.size() - 1;
}

void KeyframeGraph::addKeyframe(const SE3& T_odom_body, const Points& points_body) {
  if (keyframes_.empty()) {
    keyframes_.push_back({T_odom_body, 0, points_body});
    T_map_body_.push_back(T_odom_body);
    return;
  }
  const Keyframe& last = keyframes_.back();
  const SE3 T_last_body = last.T_odom_body.inverse() * T_odom_body;
  const double fitness = fitness_m2(last.points, points_body, T_last_body, config_.fitness_range_m);
  edges_.push_back(
      {keyframes_.size() - 1, keyframes_.size(), T_last_body, covarianceOf(fitness), /*loop=*/false});
  T_map_body_.push_back(T_map_body_.back() * T_last_body);
  keyframes_.push_back({T_odom_body, last.path_m + T_last_body.translation.norm(), points_body});
}

void KeyframeGraph::searchLoop() {
  const size_t newest = keyframes_.size() - 1;
  const double path_m = keyframes_[newest].path_m;
  if (path_m - last_loop_path_m_ < config_.loop_min_interval_m) return;
  PoseEdge best{0, newest, {}, {}, /*loop=*/true};
  double best_fitness = config_.loop_max_fitness_m2;
  bool target_set = false, found = false;
  for (size_t i = 0; i < newest; ++i) {
    if (path_m - keyframes_[i].path_m < config_.loop_min_path_m) break;  // paths grow with the index
    const SE3 T_newest_old = T_map_body_[newest].inverse() * T_map_body_[i];
    const Eigen::Vector3d apart = T_map_body_[newest].translation - T_map_body_[i].translation;
    if (apart.head<2>().norm() > config_.loop_radius_m) continue;
    if (!target_set) registration_->setTarget(keyframes_[newest].points);
    target_set = true;
    const ScanMatch match = registration_->align(keyframes_[i].points, T_newest_old);
    if (!match.converged || !match.T_target_source.isFinite()) continue;
    const double fitness = fitness_m2(keyframes_[newest].points, keyframes_[i].points, match.T_target_source,
                                      config_.fitness_range_m);
    if (fitness >= best_fitness) continue;
    best_fitness = fitness;
    best.from = i;
    best.T_from_to = match.T_target_source.inverse();
    found = true;
  }
  if (!found) return;
  best.covariance = covarianceOf(best_fitness);
  edges_.push_back(best);
  last_loop_path_m_ = path_m;
  ++loops_;
  T_map_body_ = optimisePoses(T_map_body_, edges_);
}

Matrix6d KeyframeGraph::covarianceOf(double fitness_m2) const {
  const double share = std::min(
      1.0, (1 - std::exp(-kFitnessGain * fitness_m2)) / (1 - std::exp(-kFitnessGain * kFullFitness_m2)));
  Vector6d variances;
  variances.head<3>().setConstant(between(kMinSigma_m, kMaxSigma_m, share));
  variances.tail<3>().setConstant(between(kMinSigma_rad, kMaxSigma_rad, share));
  return variances.asDiagonal();
}

}  // namespace sgraphs::bench
