#include "backend/keyframe_assembly.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace sgraphs {

KeyframeAssembly::Fate KeyframeAssembly::add(const keyframe_t& chunk) {
  if (chunk.num_chunks < 1 || chunk.num_chunks > kMaxChunks || chunk.chunk < 0 ||
      chunk.chunk >= chunk.num_chunks || (open_.size() >= kMaxOpen && !open_.contains(chunk.keyframe)))
    return Fate::kRefused;
  auto& chunks = open_[chunk.keyframe];
  if (!chunks.empty() && chunks.begin()->second.num_chunks != chunk.num_chunks) return Fate::kRefused;
  if (!chunks.try_emplace(chunk.chunk, chunk).second) return Fate::kRefused;
  return static_cast<int32_t>(chunks.size()) == chunk.num_chunks ? Fate::kComplete : Fate::kIncomplete;
}

std::optional<Keyframe> KeyframeAssembly::take(int64_t keyframe) {
  std::vector<keyframe_t> chunks;
  const auto found = open_.find(keyframe);
  if (found != open_.end())
    for (auto& [index, chunk] : found->second) chunks.push_back(std::move(chunk));
  open_.erase(open_.begin(), open_.upper_bound(keyframe));
  return fromMessages(chunks);
}

int64_t KeyframeAssembly::firstFrom(int64_t keyframe) const {
  const auto found = open_.lower_bound(keyframe);
  return found == open_.end() ? -1 : found->first;
}

void MotionSinceKeyframe::reset(int64_t scan) {
  begin_scan_ = newest_scan_ = scan;
  added_ = 0;
  covariance_.setZero();
}

void MotionSinceKeyframe::add(const OdometryEstimate& estimate) {
  if (estimate.scan <= newest_scan_) return;
  const SE3 T_previous_body = T_odom_body_.inverse() * estimate.T_odom_body;
  covariance_ = added_ == 0 ? estimate.covariance
                            : composeCovariance(covariance_, T_previous_body, estimate.covariance);
  newest_covariance_ = estimate.covariance;
  T_odom_body_ = estimate.T_odom_body;
  newest_scan_ = estimate.scan;
  ++added_;
}

Matrix6d MotionSinceKeyframe::covarianceAt(int64_t scan) const {
  const int64_t missing = std::max<int64_t>(0, scan - begin_scan_ - added_);
  return covariance_ +
         static_cast<double>(added_ == 0 ? std::max<int64_t>(1, missing) : missing) * newest_covariance_;
}

Keyframe keyframeWithoutCloud(const OdometryEstimate& estimate, const SE3& T_body_lidar) {
  Keyframe keyframe;
  keyframe.id = estimate.keyframe;
  keyframe.time = estimate.time;
  keyframe.scan = estimate.scan;
  keyframe.T_odom_body = estimate.T_odom_body;
  keyframe.T_keyframe_body = {SE3()};
  keyframe.T_body_lidar = T_body_lidar;
  return keyframe;
}

bool tieToGraph(Keyframe& keyframe, const SituationalGraph& graph, const MotionSinceKeyframe& motion) {
  const auto known = [&](KeyframeId id) { return id == keyframe.id || graph.keyframes.contains(id); };
  const size_t dropped = std::erase_if(keyframe.relative_poses, [&](const RelativePose& r) {
    return r.from == r.to || !known(r.from) || !known(r.to);
  });
  if (!keyframe.relative_poses.empty() || graph.keyframes.empty()) return dropped > 0;
  const auto& [newest, node] = *graph.keyframes.rbegin();
  keyframe.relative_poses.push_back({RelativePoseKind::kOdometry, newest, keyframe.id,
                                     node.T_odom_body.inverse() * keyframe.T_odom_body,
                                     motion.covarianceAt(keyframe.scan)});
  return true;
}

}  // namespace sgraphs
