#include <nlohmann/json.hpp>

#include "backend/output/graph_files.h"
#include "backend/output/map_cloud.h"

namespace sgraphs {
namespace {

using Json = nlohmann::ordered_json;

Json transformJson(const SE3& T) {
  const auto& q = T.rotation;
  return {{"xyz", {T.translation.x(), T.translation.y(), T.translation.z()}},
          {"qxyzw", {q.x(), q.y(), q.z(), q.w()}}};
}

Json upperTriangle(const Matrix6d& m) {
  Json entries = Json::array();
  for (int row = 0; row < 6; ++row)
    for (int col = row; col < 6; ++col) entries.push_back(m(row, col));
  return entries;
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

}  // namespace

std::string graphJson(const SituationalGraph& graph, const std::map<FloorId, FloorNode>& floors) {
  Json json;
  json["schema"] = "sgraphs/1";
  json["directed"] = false;
  json["multigraph"] = true;
  json["graph"] = {{"up", {graph.up_map.x(), graph.up_map.y(), graph.up_map.z()}}};
  Json& nodes = json["nodes"] = Json::array();
  for (const auto& [id, node] : graph.keyframes)
    nodes.push_back({{"id", id.str()},
                     {"layer", "keyframes"},
                     {"utime", node.time.us},
                     {"T_map_body", transformJson(node.T_map_body)},
                     {"floor", floorOf(node).str()}});
  for (const auto& [id, floor] : floors)
    nodes.push_back({{"id", id.str()},
                     {"layer", "floors"},
                     {"center", {floor.center_map.x(), floor.center_map.y()}},
                     {"z", floor.has_height ? Json(floor.z_m) : Json(nullptr)}});
  Json& links = json["links"] = Json::array();
  for (const auto& factor : graph.relative_poses) {
    const RelativePose& m = factor.measurement;
    links.push_back({{"source", m.from.str()},
                     {"target", m.to.str()},
                     {"kind", kindName(m.kind)},
                     {"T_source_target", transformJson(m.T_from_to)},
                     {"covariance", upperTriangle(m.covariance)}});
  }
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
