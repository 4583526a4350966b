#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/io/ply.h"
#include "common/io/tum.h"
#include "tools/eval/plan_polygon.h"

namespace sgraphs {

struct TrueRoom {
  std::string id;
  size_t floor = 0;  // index in Plan::floors_z_m
  Corners polygon;   // in the building's frame [m]

  // Corridors are neither asked for nor false (contract.md).
  bool optional() const { return id.rfind("C_", 0) == 0 || id.rfind("corridor", 0) == 0; }
};

// An upright wall along its centre line from a to b, in the building's frame [m].
struct TrueWall {
  Eigen::Vector2d a = Eigen::Vector2d::Zero();
  Eigen::Vector2d b = Eigen::Vector2d::Zero();
  double thickness_m = 0;
  double z_low_m = 0;
  double z_high_m = 0;
  bool glass = false;  // a pane: nobody is asked to find it
};

struct TrueDoorway {
  size_t floor = 0;                                    // index in Plan::floors_z_m
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // middle of the threshold [m]
  double width_m = 0;
};

// plan.json: what the building is.
struct Plan {
  SE3 T_body_lidar;
  std::vector<double> floors_z_m;  // empty only if no room or doorway asks for a storey
  std::vector<TrueRoom> rooms;
  std::vector<TrueWall> walls;
  std::vector<TrueWall> panes;  // of glazed windows, in the centre planes of their walls
  std::vector<TrueDoorway> doorways;
};

// The folder of `--truth`; the body's poses are in the building's frame.
struct Truth {
  std::vector<StampedPose> poses;
  std::optional<Plan> plan;
  std::optional<TriangleMesh> mesh;
};

// gt.tum must be there; plan.json and mesh.ply may be absent, but not broken: throws Error naming the file.
Truth readTruth(const std::string& folder);

}  // namespace sgraphs
