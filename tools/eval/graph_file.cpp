#include "tools/eval/graph_file.h"

#include <Eigen/Cholesky>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "common/base/error.h"
#include "common/io/text_file.h"

namespace sgraphs {
namespace {

using Json = nlohmann::json;

Eigen::Vector3d vectorOf(const Json& json) {
  const auto v = json.get<std::array<double, 3>>();
  return {v[0], v[1], v[2]};
}

template <int Size>
Eigen::Matrix<double, Size, Size> covarianceOf(const Json& json) {
  const auto entries = json.get<std::array<double, Size*(Size + 1) / 2>>();
  Eigen::Matrix<double, Size, Size> covariance;
  size_t next = 0;
  for (int row = 0; row < Size; ++row)
    for (int col = row; col < Size; ++col) covariance(row, col) = covariance(col, row) = entries[next++];
  return covariance;
}

EstimatedKeyframe keyframeOf(const Json& node) {
  EstimatedKeyframe keyframe;
  keyframe.time = {node.at("utime").get<int64_t>()};
  const auto q = node.at("T_map_body").at("qxyzw").get<std::array<double, 4>>();
  keyframe.T_map_body = {Eigen::Quaterniond(q[3], q[0], q[1], q[2]).normalized(),
                         vectorOf(node.at("T_map_body").at("xyz"))};
  if (node.contains("covariance")) keyframe.covariance = covarianceOf<6>(node.at("covariance"));
  return keyframe;
}

EstimatedWall wallOf(const Json& node, const std::string& path) {
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

}  // namespace

EstimatedGraph readEstimatedGraph(const std::string& graph_json_path) {
  try {
    const auto json = Json::parse(readFile(graph_json_path));
    EstimatedGraph graph;
    for (const auto& node : json.at("nodes")) {
      if (node.at("layer") == "keyframes") graph.keyframes.push_back(keyframeOf(node));
      if (node.at("layer") == "walls") graph.walls.push_back(wallOf(node, graph_json_path));
    }
    return graph;
  } catch (const Json::exception& error) {
    throw Error("cannot read graph '" + graph_json_path + "': " + error.what());
  }
}

}  // namespace sgraphs
