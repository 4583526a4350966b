#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "common/base/ids.h"
#include "common/base/time.h"
#include "common/geometry/se3.h"
#include "common/types/keyframe.h"

namespace sgraphs {

struct KeyframeNode {
  KeyframeId id;
  Time time;
  SE3 T_map_body;
  SE3 T_odom_body;
  FloorId floor;
  std::shared_ptr<const Keyframe> keyframe;  // cloud, viewpoints and measurements as they arrived
};

struct FloorNode {
  FloorId id;
  Eigen::Vector2d center_map = Eigen::Vector2d::Zero();
  bool has_height = false;
  double z_m = 0;  // height of the walking surface in map
};

// A measurement that binds nodes. Walls, rooms and floors add their own factor lists beside these.
struct RelativePoseFactor {
  int64_t id = 0;  // monotonic over all kinds of factors
  RelativePose measurement;
};

struct UpFactor {
  int64_t id = 0;
  KeyframeId keyframe;
  Eigen::Vector3d up_body = Eigen::Vector3d::UnitZ();
  double sigma_rad = 0;
};

// The layers and what binds them: plain data in ordered containers; walls and rooms join as further maps of
// nodes and lists of factors. Only the backend changes it.
struct SituationalGraph {
  std::map<KeyframeId, KeyframeNode> keyframes;
  std::map<FloorId, FloorNode> floors;
  Eigen::Vector3d up_map = Eigen::Vector3d::UnitZ();  // state on the unit sphere

  std::vector<RelativePoseFactor> relative_poses;
  std::vector<UpFactor> ups;

  // SHA-256 of the canonical snapshot: nodes by layer and id, factors by kind and ids, doubles as IEEE bits.
  std::string digest() const;

  // Throws std::logic_error if a factor names a node that does not exist or a pose is not finite.
  void check() const;
};

}  // namespace sgraphs
