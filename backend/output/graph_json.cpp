#include <nlohmann/json.hpp>

#include "backend/output/graph_files.h"
#include "backend/output/graph_layers_json.h"
#include "backend/output/map_cloud.h"
#include "common/geometry/tangent_basis.h"

namespace sgraphs {
namespace {

using Json = nlohmann::ordered_json;

Json transformJson(const SE3& T) {
  const auto& q = T.rotation;
  return {{"xyz", {T.translation.x(), T.translation.y(), T.translation.z()}},
          {"qxyzw", {q.x(), q.y(), q.z(), q.w()}}};
}

template <typename Derived>
Json upperTriangle(const Eigen::MatrixBase<Derived>& m) {
  Json entries = Json::array();
  for (Eigen::Index row = 0; row < m.rows(); ++row)
    for (Eigen::Index col = row; col < m.cols(); ++col) entries.push_back(m(row, col));
  return entries;
}

Json vectorJson(const Eigen::Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}

Json keyframeJson(const KeyframeNode& node, const std::map<KeyframeId, Matrix6d>& covariances,
                  std::span<const SessionClock> sessions) {
  Json json = {{"id", node.id.str()},
               {"layer", "keyframes"},
               {"utime", recordedTime(sessions, node.time).us},
               {"T_map_body", transformJson(node.T_map_body)},
               {"floor", floorOf(node).str()}};
  if (sessions.size() > 1) json["session"] = sessionAt(sessions, node.time);
  const auto covariance = covariances.find(node.id);
  if (covariance != covariances.end()) json["covariance"] = upperTriangle(covariance->second);
  return json;
}

// The tangent moves the normal along u and v. A turn about v moves it along u, one about -u along v.
Json wallJson(const PlaneNode& plane) {
  const TangentBasis basis = tangentBasis(plane.normal_map);
  const Eigen::Vector3d centroid = plane.centroid_map - plane.distance(plane.centroid_map) * plane.normal_map;
  Json polygon = Json::array();
  for (const Eigen::Vector3d& corner : plane.polygon_map) polygon.push_back(vectorJson(corner));
  return {{"id", plane.id.str()},
          {"layer", "walls"},
          {"label", toString(plane.label)},
          {"normal", vectorJson(plane.normal_map)},
          {"d", plane.d()},
          {"centroid", vectorJson(centroid)},
          {"axes", {{"u", vectorJson(basis.col(1))}, {"v", vectorJson(-basis.col(0))}}},
          {"covariance", upperTriangle(plane.covariance)},
          {"polygon", std::move(polygon)},
          {"floor", (plane.floor.valid() ? plane.floor : FloorId{0}).str()}};
}

const char* kindName(RelativePoseKind kind) {
  switch (kind) {
    case RelativePoseKind::kOdometry:
      return "odometry";
    case RelativePoseKind::kNeighbour:
      return "neighbour";
    case RelativePoseKind::kLoop:
      return "loop";
  }
  throw std::logic_error("unknown kind of relative pose");
}

Json linksJson(const SituationalGraph& graph) {
  Json links = Json::array();
  for (const auto& factor : graph.relative_poses) {
    const RelativePose& m = factor.measurement;
    links.push_back({{"source", m.from.str()},
                     {"target", m.to.str()},
                     {"kind", kindName(m.kind)},
                     {"T_source_target", transformJson(m.T_from_to)},
                     {"covariance", upperTriangle(m.covariance)}});
  }
  for (const auto& factor : graph.observations)
    links.push_back(
        {{"source", factor.keyframe.str()}, {"target", factor.plane.str()}, {"kind", "observes"}});
  for (const auto& factor : graph.faces)
    links.push_back({{"source", factor.a.str()}, {"target", factor.b.str()}, {"kind", "faces"}});
  return links;
}

}  // namespace

std::string graphJson(const SituationalGraph& graph, const std::map<FloorId, FloorNode>& floors,
                      const std::map<KeyframeId, Matrix6d>& keyframe_covariances,
                      std::span<const SessionClock> sessions) {
  Json json;
  json["schema"] = "sgraphs/1";
  json["directed"] = false;
  json["multigraph"] = true;
  json["graph"] = {{"up", vectorJson(graph.up_map)}};
  Json& nodes = json["nodes"] = Json::array();
  for (const auto& [id, node] : graph.keyframes)
    nodes.push_back(keyframeJson(node, keyframe_covariances, sessions));
  for (const auto& [id, plane] : graph.planes) nodes.push_back(wallJson(plane));
  for (const auto& [id, floor] : floors)
    nodes.push_back({{"id", id.str()},
                     {"layer", "floors"},
                     {"center", {floor.center_map.x(), floor.center_map.y()}},
                     {"z", floor.has_height ? Json(floor.z_m) : Json(nullptr)},
                     {"height_known", floor.height_known}});
  addUpperLayerNodes(graph, sessions, nodes);
  json["links"] = linksJson(graph);
  addUpperLayerLinks(graph, json["links"]);
  // One node or link per line: small enough to read, and to compare with diff.
  std::string text = "{\n";
  for (auto item = json.begin(); item != json.end(); ++item) {
    text += " \"" + item.key() + "\": ";
    if (item.value().is_array()) {
      text += "[";
      for (size_t i = 0; i < item.value().size(); ++i)
        text += std::string(i ? "," : "") + "\n  " + item.value()[i].dump();
      text += "\n ]";
    } else {
      text += item.value().dump();
    }
    text += std::next(item) == json.end() ? "\n" : ",\n";
  }
  return text + "}\n";
}

}  // namespace sgraphs
