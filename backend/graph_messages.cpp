#include "backend/graph_messages.h"

#include <set>
#include <stdexcept>
#include <utility>

#include "backend/graph/map_plane.h"
#include "lcmtypes/convert/chunks.h"
#include "lcmtypes/convert/convert.h"

namespace sgraphs {
namespace {

graph_node_t toMessage(const KeyframeNode& node) {
  graph_node_t m{};
  m.layer = graph_node_t::KEYFRAMES;
  m.id = node.id.value;
  m.floor = node.floor.value;
  m.utime = node.time.us;
  m.T_map_node = toMessage(node.T_map_body);
  return m;
}

graph_node_t toMessage(const FloorNode& node) {
  graph_node_t m{};
  m.layer = graph_node_t::FLOORS;
  m.id = m.floor = node.id.value;
  const double z_m = node.has_height ? node.z_m : 0.0;
  m.T_map_node =
      toMessage(SE3(Eigen::Quaterniond::Identity(), {node.center_map.x(), node.center_map.y(), z_m}));
  return m;
}

graph_node_t toMessage(const RoomNode& node) {
  graph_node_t m{};
  m.layer = graph_node_t::ROOMS;
  m.id = node.id.value;
  m.floor = node.seen.floor.value;
  m.T_map_node =
      toMessage(SE3(Eigen::Quaterniond::Identity(), {node.center_map.x(), node.center_map.y(), 0}));
  return m;
}

graph_plane_t planeMessage(const SituationalGraph& graph, PlaneId id) {
  if (const auto node = graph.planes.find(id); node != graph.planes.end())
    return toMessage(mapPlane(node->second));
  if (!graph.merged_planes.contains(id))
    throw std::logic_error("graph messages: plane " + id.str() + " changed, but is neither there nor merged");
  MapPlane merged;
  merged.id = id;
  merged.merged_into = livesOnIn(graph, id);
  return toMessage(merged);
}

graph_update_t headOf(const SituationalGraph& graph, const RoundOutput& output, int64_t round, Time time,
                      bool idle) {
  graph_update_t m{};
  m.header.utime = time.us;
  m.round = round;
  m.keyframe = graph.keyframes.empty() ? -1 : graph.keyframes.rbegin()->first.value;
  for (int r = 0; r < 6; ++r)
    for (int c = 0; c < 6; ++c) m.keyframe_covariance[6 * r + c] = output.keyframe_covariance(r, c);
  m.idle = idle;
  m.graph_digest = output.graph_digest;
  return m;
}

using Chunks = ChunkFiller<graph_update_t>;

std::vector<graph_update_t> finished(Chunks chunks) {
  return chunks.finish([](graph_update_t& m) {
    m.num_nodes = static_cast<int32_t>(m.nodes.size());
    m.num_planes = static_cast<int32_t>(m.planes.size());
  });
}

void addUpperLayers(const SituationalGraph& graph, Chunks& chunks) {
  for (const auto& [id, node] : graph.rooms) chunks.add(&graph_update_t::nodes, toMessage(node));
  for (const auto& [id, node] : graph.floors) chunks.add(&graph_update_t::nodes, toMessage(node));
}

}  // namespace

std::vector<graph_update_t> updateMessages(const SituationalGraph& graph, const RoundOutput& output,
                                           int64_t round, Time time, bool idle) {
  Chunks chunks(headOf(graph, output, round, time, idle));
  for (const KeyframeId id : output.changed) {
    const auto node = graph.keyframes.find(id);
    if (node == graph.keyframes.end())
      throw std::logic_error("graph messages: keyframe " + id.str() + " changed, but is not there");
    chunks.add(&graph_update_t::nodes, toMessage(node->second));
  }
  if (output.changed_rooms) addUpperLayers(graph, chunks);
  const std::set<PlaneId> changed(output.changed_planes.begin(), output.changed_planes.end());
  for (const PlaneId id : changed) chunks.add(&graph_update_t::planes, planeMessage(graph, id));
  return finished(std::move(chunks));
}

std::vector<graph_update_t> snapshotMessages(const SituationalGraph& graph, const RoundOutput& newest,
                                             int64_t round, Time time) {
  graph_update_t head = headOf(graph, newest, round, time, false);
  head.complete = 1;
  Chunks chunks(head);
  for (const auto& [id, node] : graph.keyframes) chunks.add(&graph_update_t::nodes, toMessage(node));
  addUpperLayers(graph, chunks);
  std::set<PlaneId> planes;
  for (const auto& [id, node] : graph.planes) planes.insert(id);
  for (const auto& [id, into] : graph.merged_planes) planes.insert(id);
  for (const PlaneId id : planes) chunks.add(&graph_update_t::planes, planeMessage(graph, id));
  return finished(std::move(chunks));
}

}  // namespace sgraphs
