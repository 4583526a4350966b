#pragma once

#include <map>
#include <optional>

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

// Stands in for a keyframe whose message was lost: its pose by odometry, without cloud or measurements (the
// backend ties it to the graph by the odometry poses).
Keyframe keyframeWithoutCloud(const OdometryEstimate& estimate, const SE3& T_body_lidar);

}  // namespace sgraphs
