#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "common/base/time.h"
#include "common/geometry/se3.h"
#include "tools/eval/plan_polygon.h"

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

struct EstimatedRoom {
  std::string id;
  std::string floor;             // id of its floor; empty if the file does not say
  Corners polygon;               // in map; what the file says, even if that is no outline
  std::optional<Time> accepted;  // first in its present form
};

struct EstimatedFloor {
  std::string id;
  Eigen::Vector2d center = Eigen::Vector2d::Zero();
  std::optional<double> z_m;  // of the walking surface
  bool height_known = true;   // false: a lift led there, and z_m is where the map has put it
};

struct EstimatedDoorway {
  std::string source, target;
  std::string floor;  // of the source, else of the target; empty if neither says
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  double width_m = 0;
};

// Each in the file's order: by id.
struct EstimatedGraph {
  std::vector<EstimatedKeyframe> keyframes;
  std::vector<EstimatedWall> walls;
  std::vector<EstimatedRoom> rooms;
  std::vector<EstimatedFloor> floors;
  std::vector<EstimatedDoorway> doorways;
};

// What graph.json says of them; of a map of several sessions keyframes, and times of rooms, of the last one.
// Throws Error naming the file and what is wrong with it.
EstimatedGraph readEstimatedGraph(const std::string& graph_json_path);

}  // namespace sgraphs
