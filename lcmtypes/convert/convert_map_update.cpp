#include <map>

#include "lcmtypes/convert/convert.h"
#include "lcmtypes/convert/convert_layers.h"

namespace sgraphs {
namespace {

std::optional<MapKeyframe> keyframeFrom(const graph_node_t& m) {
  const std::optional<SE3> T_map_node = fromMessage(m.T_map_node);
  if (m.id < 0 || m.floor < -1 || !T_map_node) return std::nullopt;
  return MapKeyframe{KeyframeId{m.id}, FloorId{m.floor}, Time{m.utime}, *T_map_node};
}

}  // namespace

std::optional<MapUpdate> fromMessages(std::span<const graph_update_t> chunks) {
  if (chunks.empty()) return std::nullopt;
  const graph_update_t& head = chunks.front();
  if (head.round < 0 || head.keyframe < -1) return std::nullopt;
  MapUpdate update{.round = head.round,
                   .time = Time{head.header.utime},
                   .newest = KeyframeId{head.keyframe},
                   .idle = head.idle != 0,
                   .newest_covariance = Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(
                       head.keyframe_covariance),
                   .keyframes = {},
                   .planes = {}};
  if (!update.newest_covariance.allFinite()) return std::nullopt;
  for (const graph_update_t& chunk : chunks) {
    if (chunk.round != head.round) return std::nullopt;
    for (const graph_node_t& node : chunk.nodes) {
      if (node.layer != graph_node_t::KEYFRAMES) continue;
      const auto keyframe = keyframeFrom(node);
      if (!keyframe) return std::nullopt;
      update.keyframes.push_back(*keyframe);
    }
    for (const graph_plane_t& m : chunk.planes) {
      std::optional<MapPlane> plane = fromMessage(m);
      if (!plane) return std::nullopt;
      update.planes.push_back(std::move(*plane));
    }
  }
  return update;
}

}  // namespace sgraphs
