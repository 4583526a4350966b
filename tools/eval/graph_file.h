#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "common/base/time.h"
#include "common/geometry/se3.h"

namespace sgraphs {

// A wall face, floor or ceiling of graph.json, in map.
struct EstimatedWall {
  std::string id;
  std::string label;
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();
  // A turn about axis_u by tilt_u and about axis_v by tilt_v, then offset along the normal at the centroid,
  // leads to the true plane.
  Eigen::Vector3d axis_u = Eigen::Vector3d::UnitX();
  Eigen::Vector3d axis_v = Eigen::Vector3d::UnitY();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();  // of (tilt_u, tilt_v [rad], offset [m])
  std::vector<Eigen::Vector3d> polygon;

  bool vertical() const { return label != "horizontal"; }
};

struct EstimatedKeyframe {
  Time time;
  SE3 T_map_body;
  std::optional<Matrix6d> covariance;  // of T_map_body given the first keyframe, tangent of body
};

struct EstimatedGraph {
  std::vector<EstimatedKeyframe> keyframes;  // in the file's order: by id
  std::vector<EstimatedWall> walls;
};

// What graph.json says of keyframes and walls. Throws Error naming the file and what is wrong with it.
EstimatedGraph readEstimatedGraph(const std::string& graph_json_path);

}  // namespace sgraphs
