#include "tools/eval/graph_file.h"

#include <Eigen/Cholesky>
#include <array>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "common/base/error.h"
#include "common/io/text_file.h"
#include "tools/eval/graph_sessions.h"

namespace sgraphs {
namespace {

Eigen::Vector3d vectorOf(const nlohmann::json& json) {
  const auto v = json.get<std::array<double, 3>>();
  return {v[0], v[1], v[2]};
}

template <int Size>
Eigen::Matrix<double, Size, Size> covarianceOf(const nlohmann::json& json) {
  const auto entries = json.get<std::array<double, Size*(Size + 1) / 2>>();
  Eigen::Matrix<double, Size, Size> covariance;
  size_t next = 0;
  for (int row = 0; row < Size; ++row)
    for (int col = row; col < Size; ++col) covariance(row, col) = covariance(col, row) = entries[next++];
  return covariance;
}

EstimatedKeyframe keyframeOf(const nlohmann::json& node) {
  EstimatedKeyframe keyframe;
  keyframe.time = {node.at("utime").get<int64_t>()};
  const auto q = node.at("T_map_body").at("qxyzw").get<std::array<double, 4>>();
  keyframe.T_map_body = {Eigen::Quaterniond(q[3], q[0], q[1], q[2]).normalized(),
                         vectorOf(node.at("T_map_body").at("xyz"))};
  if (node.contains("covariance")) keyframe.covariance = covarianceOf<6>(node.at("covariance"));
  return keyframe;
}

EstimatedWall wallOf(const nlohmann::json& node, const std::string& path) {
  EstimatedWall wall;
  wall.id = node.at("id");
  wall.label = node.at("label");
  wall.normal = vectorOf(node.at("normal"));
  wall.centroid = vectorOf(node.at("centroid"));
  wall.axis_u = vectorOf(node.at("axes").at("u"));
  wall.axis_v = vectorOf(node.at("axes").at("v"));
  wall.covariance = covarianceOf<3>(node.at("covariance"));
  for (const auto& corner : node.at("polygon")) wall.polygon.push_back(vectorOf(corner));
  const auto refuse = [&](const std::string& what) {
    throw Error("cannot read graph '" + path + "': wall " + wall.id + " " + what);
  };
  if (std::abs(wall.normal.norm() - 1) > 1e-3) refuse("has a normal that is no unit vector");
  if (wall.polygon.size() < 3) refuse("has a polygon of less than three corners");
  if (wall.covariance.llt().info() != Eigen::Success) refuse("has a covariance that is not positive");
  return wall;
}

// Empty where the file says nothing or null.
std::string textOf(const nlohmann::json& json, const char* key) {
  const auto found = json.find(key);
  return found == json.end() || found->is_null() ? std::string() : found->get<std::string>();
}

EstimatedRoom roomOf(const nlohmann::json& node) {
  EstimatedRoom room;
  room.id = node.at("id");
  room.floor = textOf(node, "floor");
  if (node.contains("polygon") && !node["polygon"].is_null())
    for (const auto& corner : node["polygon"]) room.polygon.emplace_back(corner.at(0), corner.at(1));
  if (node.contains("utime") && !node["utime"].is_null()) room.accepted = Time{node["utime"].get<int64_t>()};
  return room;
}

EstimatedFloor floorOf(const nlohmann::json& node) {
  EstimatedFloor floor;
  floor.id = node.at("id");
  if (node.contains("center"))
    floor.center = {node["center"].at(0).get<double>(), node["center"].at(1).get<double>()};
  if (node.contains("z") && !node["z"].is_null()) floor.z_m = node["z"].get<double>();
  floor.height_known = node.value("height_known", true);
  return floor;
}

EstimatedDoorway doorwayOf(const nlohmann::json& link, const std::map<std::string, std::string>& floors) {
  EstimatedDoorway doorway;
  doorway.source = link.at("source");
  doorway.target = link.at("target");
  for (const std::string& end : {doorway.source, doorway.target})
    if (const auto floor = floors.find(end); doorway.floor.empty() && floor != floors.end())
      doorway.floor = floor->second;
  doorway.position = vectorOf(link.at("xyz"));
  doorway.width_m = link.at("width");
  return doorway;
}

}  // namespace

EstimatedGraph readEstimatedGraph(const std::string& graph_json_path) {
  try {
    const auto json = nlohmann::json::parse(readFile(graph_json_path));
    EstimatedGraph graph;
    std::map<std::string, std::string> floor_of_node;
    const int session = lastSession(json);
    for (const auto& node : json.at("nodes")) {
      floor_of_node[node.at("id")] = textOf(node, "floor");
      if (node.at("layer") == "keyframes" && sessionOf(node) == session) {
        graph.keyframes.push_back(keyframeOf(node));
        // Given the first keyframe of the map, of which this truth knows nothing.
        if (session > 0) graph.keyframes.back().covariance.reset();
      }
      if (node.at("layer") == "walls") graph.walls.push_back(wallOf(node, graph_json_path));
      if (node.at("layer") == "rooms") {
        graph.rooms.push_back(roomOf(node));
        // What was known before was detected by none of this run's scans.
        if (sessionOf(node) != session) graph.rooms.back().accepted.reset();
      }
      if (node.at("layer") == "floors") graph.floors.push_back(floorOf(node));
    }
    for (const auto& link : json.at("links"))
      if (link.at("kind") == "doorway") graph.doorways.push_back(doorwayOf(link, floor_of_node));
    return graph;
  } catch (const nlohmann::json::exception& error) {
    throw Error("cannot read graph '" + graph_json_path + "': " + error.what());
  }
}

}  // namespace sgraphs
