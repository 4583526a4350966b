#include "backend/graph_messages.h"

#include <algorithm>
#include <utility>

#include "lcmtypes/convert/convert.h"

namespace sgraphs {
namespace {

constexpr size_t kNodesPerChunk = 500;  // of 84 bytes

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

std::vector<graph_update_t> chunked(std::vector<graph_node_t> nodes, graph_update_t head) {
  head.num_chunks =
      static_cast<int32_t>(std::max<size_t>(1, (nodes.size() + kNodesPerChunk - 1) / kNodesPerChunk));
  std::vector<graph_update_t> chunks;
  for (head.chunk = 0; head.chunk < head.num_chunks; ++head.chunk) {
    const size_t begin = kNodesPerChunk * static_cast<size_t>(head.chunk);
    const size_t end = std::min(nodes.size(), begin + kNodesPerChunk);
    graph_update_t& m = chunks.emplace_back(head);
    m.nodes.assign(nodes.begin() + static_cast<std::ptrdiff_t>(begin),
                   nodes.begin() + static_cast<std::ptrdiff_t>(end));
    m.num_nodes = static_cast<int32_t>(m.nodes.size());
  }
  return chunks;
}

graph_update_t headOf(const SituationalGraph& graph, const RoundOutput& output, int64_t round, Time time) {
  graph_update_t m{};
  m.header.utime = time.us;
  m.round = round;
  m.keyframe = graph.keyframes.empty() ? -1 : graph.keyframes.rbegin()->first.value;
  for (int r = 0; r < 6; ++r)
    for (int c = 0; c < 6; ++c) m.keyframe_covariance[6 * r + c] = output.keyframe_covariance(r, c);
  m.graph_digest = output.graph_digest;
  return m;
}

}  // namespace

std::vector<graph_update_t> updateMessages(const SituationalGraph& graph, const RoundOutput& output,
                                           int64_t round, Time time) {
  std::vector<graph_node_t> nodes;
  for (const KeyframeId id : output.changed) nodes.push_back(toMessage(graph.keyframes.at(id)));
  return chunked(std::move(nodes), headOf(graph, output, round, time));
}

std::vector<graph_update_t> snapshotMessages(const SituationalGraph& graph, const RoundOutput& newest,
                                             int64_t round, Time time) {
  std::vector<graph_node_t> nodes;
  for (const auto& [id, node] : graph.keyframes) nodes.push_back(toMessage(node));
  for (const auto& [id, node] : graph.floors) nodes.push_back(toMessage(node));
  graph_update_t head = headOf(graph, newest, round, time);
  head.complete = 1;
  return chunked(std::move(nodes), head);
}

}  // namespace sgraphs
