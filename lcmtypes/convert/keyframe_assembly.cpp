#include "lcmtypes/convert/keyframe_assembly.h"

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

}  // namespace sgraphs
