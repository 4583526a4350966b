#pragma once

#include <map>
#include <optional>
#include <string>

#include "backend/graph/situational_graph.h"
#include "common/types/keyframe.h"
#include "lcmtypes/convert/convert.h"

namespace sgraphs {

// Collects the chunks of keyframes.
class KeyframeAssembly {
 public:
  static constexpr size_t kMaxOpen = 1000;  // keyframes
  static constexpr int kMaxChunks = 1000;   // of one keyframe

  enum class Fate { kIncomplete, kComplete, kRefused };
  Fate add(const keyframe_t& chunk);
  // The keyframe from the chunks that came, and nothing if none came or their content cannot be right. Its
  // chunks and those of earlier keyframes are forgotten.
  std::optional<Keyframe> take(int64_t keyframe);
  // Oldest keyframe with a chunk here, from this id on; -1: none.
  int64_t firstFrom(int64_t keyframe) const;
  bool contains(int64_t keyframe) const { return open_.contains(keyframe); }
  size_t size() const { return open_.size(); }

 private:
  std::map<int64_t, std::map<int32_t, keyframe_t>> open_;  // keyframe -> chunk
};

// Motion of the body since the newest keyframe, by the odometry of each scan.
class MotionSinceKeyframe {
 public:
  void reset(int64_t scan);
  // Scans in order; one that was added before changes nothing.
  void add(const OdometryEstimate& estimate);
  // Covariance of the motion up to this scan; scans whose odometry is missing count like the newest known.
  Matrix6d covarianceAt(int64_t scan) const;

 private:
  int64_t begin_scan_ = -1;
  int64_t newest_scan_ = -1;
  int64_t added_ = 0;
  SE3 T_odom_body_;
  Matrix6d covariance_ = Matrix6d::Zero();
  Matrix6d newest_covariance_ = Matrix6d::Identity();
};

// Stands in for a keyframe whose message was lost: its pose by odometry, without a cloud.
Keyframe keyframeWithoutCloud(const OdometryEstimate& estimate, const SE3& T_body_lidar);

// After a loss: measurements against keyframes that the graph does not hold are dropped, and a keyframe left
// without any is tied to the newest one by odometry. Returns whether anything had to be changed.
bool tieToGraph(Keyframe& keyframe, const SituationalGraph& graph, const MotionSinceKeyframe& motion);

}  // namespace sgraphs
