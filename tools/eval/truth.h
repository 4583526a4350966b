#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/io/ply.h"
#include "common/io/tum.h"

namespace sgraphs {

struct TrueRoom {
  std::string id;
  int floor = 0;
  std::vector<Eigen::Vector2d> polygon;  // in the building's frame [m]

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
};

// plan.json: what the building is.
struct Plan {
  SE3 T_body_lidar;
  std::vector<double> floors_z_m;
  std::vector<TrueRoom> rooms;
  std::vector<TrueWall> walls;
  size_t num_doorways = 0;
};

// The folder of `--truth`; the body's poses are in the building's frame.
struct Truth {
  std::vector<StampedPose> poses;
  std::optional<Plan> plan;
  std::optional<TriangleMesh> mesh;
};

// gt.tum must be there; plan.json and mesh.ply may be absent, but not broken: throws Error naming the file.
Truth readTruth(const std::string& folder);

// Rooms that the path is inside of for at least a second, corridors left out.
std::vector<TrueRoom> askedRooms(const Plan& plan, const std::vector<StampedPose>& poses);

}  // namespace sgraphs
