#include <cmath>
#include <stdexcept>

#include "lcmtypes/convert/chunks.h"
#include "lcmtypes/convert/convert_layers.h"

namespace sgraphs {
namespace {

constexpr size_t kMaxNeighbours = 100;
constexpr size_t kMaxBorderCorners = 2000;

// Bytes as they are sent: a difference that a message cannot carry is none.
template <typename Message>
std::vector<uint8_t> encoded(const Message& m) {
  std::vector<uint8_t> bytes(static_cast<size_t>(m.getEncodedSize()));
  m.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  return bytes;
}

free_space_vertex_t toMessage(const FreeSpaceVertex& vertex) {
  free_space_vertex_t m{};
  m.id = vertex.id.value;
  m.floor = vertex.floor.value;
  m.cluster = vertex.cluster.value;
  for (int i = 0; i < 3; ++i) m.position[i] = vertex.position_map[i];
  m.clearance_m = vertex.clearance_m;
  for (const VertexId neighbour : vertex.neighbours) m.neighbours.push_back(neighbour.value);
  m.num_neighbours = static_cast<int32_t>(m.neighbours.size());
  return m;
}

std::optional<FreeSpaceVertex> fromMessage(const free_space_vertex_t& m) {
  FreeSpaceVertex vertex;
  vertex.id = VertexId{m.id};
  vertex.floor = FloorId{m.floor};
  vertex.cluster = ClusterId{m.cluster};
  vertex.position_map = Eigen::Vector3f(m.position);
  vertex.clearance_m = m.clearance_m;
  if (m.id < 0 || m.floor < -1 || m.cluster < -1 || !vertex.position_map.allFinite() ||
      !(m.clearance_m >= 0) || m.neighbours.size() > kMaxNeighbours)
    return std::nullopt;
  for (const int64_t neighbour : m.neighbours) {
    if (neighbour < 0 || (!vertex.neighbours.empty() && neighbour <= vertex.neighbours.back().value))
      return std::nullopt;
    vertex.neighbours.push_back(VertexId{neighbour});
  }
  return vertex;
}

free_space_cluster_t toMessage(const FreeSpaceCluster& cluster) {
  if (cluster.border.size() > kMaxBorderCorners)
    throw std::logic_error("cluster " + cluster.id.str() + " has more corners than a message holds");
  free_space_cluster_t m{};
  m.id = cluster.id.value;
  m.floor = cluster.floor.value;
  m.is_corridor = cluster.is_corridor;
  m.area_m2 = cluster.area_m2;
  m.max_clearance_m = cluster.max_clearance_m;
  for (int i = 0; i < 2; ++i) m.center[i] = cluster.center_map[i];
  for (const BorderCorner& corner : cluster.border) {
    m.border.push_back({corner.position_map.x(), corner.position_map.y()});
    m.kind.push_back(static_cast<int8_t>(corner.kind));
  }
  m.num_corners = static_cast<int32_t>(m.border.size());
  return m;
}

std::optional<FreeSpaceCluster> fromMessage(const free_space_cluster_t& m) {
  FreeSpaceCluster cluster;
  cluster.id = ClusterId{m.id};
  cluster.floor = FloorId{m.floor};
  cluster.is_corridor = m.is_corridor != 0;
  cluster.area_m2 = m.area_m2;
  cluster.max_clearance_m = m.max_clearance_m;
  cluster.center_map = Eigen::Vector2f(m.center);
  if (m.id < 0 || m.floor < -1 || !(m.area_m2 >= 0) || !(m.max_clearance_m >= 0) ||
      !cluster.center_map.allFinite() || m.border.size() > kMaxBorderCorners)
    return std::nullopt;
  for (size_t i = 0; i < m.border.size(); ++i) {
    const BorderCorner corner{{m.border[i][0], m.border[i][1]}, static_cast<BorderKind>(m.kind[i])};
    if (!corner.position_map.allFinite() || m.kind[i] < free_space_cluster_t::OBSTACLE ||
        m.kind[i] > free_space_cluster_t::PASSAGE)
      return std::nullopt;
    cluster.border.push_back(corner);
  }
  return cluster;
}

passage_t toMessage(const Passage& passage) {
  passage_t m{};
  m.id = passage.id.value;
  m.floor = passage.floor.value;
  m.cluster_a = passage.a.value;
  m.cluster_b = passage.b.value;
  for (int i = 0; i < 2; ++i) {
    m.left[i] = passage.left_map[i];
    m.right[i] = passage.right_map[i];
  }
  m.z_m = passage.z_m;
  m.is_door = passage.is_door;
  return m;
}

std::optional<Passage> fromMessage(const passage_t& m) {
  Passage passage{.id = PassageId{m.id},
                  .floor = FloorId{m.floor},
                  .a = ClusterId{m.cluster_a},
                  .b = ClusterId{m.cluster_b},
                  .left_map = Eigen::Vector2f(m.left),
                  .right_map = Eigen::Vector2f(m.right),
                  .z_m = m.z_m,
                  .is_door = m.is_door != 0};
  if (m.id < 0 || m.floor < -1 || m.cluster_a < 0 || m.cluster_b < 0 || !passage.left_map.allFinite() ||
      !passage.right_map.allFinite() || !std::isfinite(m.z_m))
    return std::nullopt;
  return passage;
}

template <typename Node, typename NodeId, typename Record>
void addChanges(ChunkFiller<free_space_t>& chunks, const std::map<NodeId, Node>& before,
                const std::map<NodeId, Node>& now, std::vector<Record> free_space_t::*records,
                std::vector<int64_t> free_space_t::*removed) {
  for (const auto& [id, node] : now) {
    const Record record = toMessage(node);
    const auto known = before.find(id);
    if (known == before.end() || encoded(toMessage(known->second)) != encoded(record))
      chunks.add(records, record);
  }
  for (const auto& [id, node] : before)
    if (!now.contains(id)) chunks.add(removed, id.value);
}

template <typename Node, typename NodeId, typename Record>
bool applyChanges(std::map<NodeId, Node>& nodes, const std::vector<Record>& records,
                  const std::vector<int64_t>& removed) {
  for (const Record& record : records) {
    const std::optional<Node> node = fromMessage(record);
    if (!node) return false;
    nodes[node->id] = *node;
  }
  for (const int64_t id : removed) nodes.erase(NodeId{id});
  return true;
}

}  // namespace

std::vector<free_space_t> toMessages(const FreeSpace& before, const FreeSpace& now,
                                     const std::string& why_not) {
  free_space_t head{};
  head.header.utime = now.time.us;
  head.round = now.round;
  head.why_not = why_not;
  ChunkFiller<free_space_t> chunks(head);
  addChanges(chunks, before.vertices, now.vertices, &free_space_t::vertices, &free_space_t::removed_vertices);
  addChanges(chunks, before.clusters, now.clusters, &free_space_t::clusters, &free_space_t::removed_clusters);
  addChanges(chunks, before.passages, now.passages, &free_space_t::passages, &free_space_t::removed_passages);
  return chunks.finish([](free_space_t& m) {
    m.num_vertices = static_cast<int32_t>(m.vertices.size());
    m.num_clusters = static_cast<int32_t>(m.clusters.size());
    m.num_passages = static_cast<int32_t>(m.passages.size());
    m.num_removed_vertices = static_cast<int32_t>(m.removed_vertices.size());
    m.num_removed_clusters = static_cast<int32_t>(m.removed_clusters.size());
    m.num_removed_passages = static_cast<int32_t>(m.removed_passages.size());
  });
}

bool applyMessages(std::span<const free_space_t> chunks, FreeSpace& free_space) {
  if (chunks.empty() || chunks.front().round <= free_space.round) return false;
  FreeSpace next = free_space;
  next.round = chunks.front().round;
  next.time = Time{chunks.front().header.utime};
  for (const free_space_t& m : chunks)
    if (m.round != next.round || !applyChanges(next.vertices, m.vertices, m.removed_vertices) ||
        !applyChanges(next.clusters, m.clusters, m.removed_clusters) ||
        !applyChanges(next.passages, m.passages, m.removed_passages))
      return false;
  free_space = std::move(next);
  return true;
}

}  // namespace sgraphs
