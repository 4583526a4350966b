#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "common/base/ids.h"
#include "common/base/time.h"
#include "common/geometry/se3.h"
#include "common/types/free_space.h"
#include "common/types/keyframe.h"
#include "common/types/plane.h"
#include "common/types/rooms.h"

namespace sgraphs {

struct KeyframeNode {
  KeyframeId id;
  Time time;
  SE3 T_map_body;
  SE3 T_odom_body;
  FloorId floor;
  std::shared_ptr<const Keyframe> keyframe;  // cloud, viewpoints and measurements as they arrived
  Matrix6d covariance = Matrix6d::Zero();    // of T_map_body: an upper bound, from when it was the newest
};

inline constexpr double kPlumbNormal = 0.1;  // |n.z| of a wall, at most

const char* toString(PlaneLabel label);  // "x", "y", "horizontal", as graph.json has it

// A wall face, a floor or a ceiling. The axes of its tangents are u, v = tangentBasis(normal_map).
struct PlaneNode {
  PlaneId id;
  PlaneLabel label = PlaneLabel::kHorizontal;
  FloorId floor;
  // State: normal.(p - anchor) + offset = 0, the normal towards the side it was seen from. The anchor is the
  // first centroid seen and no state.
  Eigen::Vector3d normal_map = Eigen::Vector3d::UnitZ();
  Eigen::Vector3d anchor_map = Eigen::Vector3d::Zero();
  double offset_m = 0;
  // Conservative, of (tilt_u [rad], tilt_v [rad], offset [m]) at the centroid: the true plane passes at
  // centroid + offset n.
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();
  // What has been seen of it: the centre on the plane, and a polygon counter-clockwise seen from the
  // observer.
  Eigen::Vector3d centroid_map = Eigen::Vector3d::Zero();
  std::vector<Eigen::Vector3d> polygon_map;
  int64_t num_observations = 0;

  double d() const { return offset_m - normal_map.dot(anchor_map); }  // n.p + d = 0 in map
  double distance(const Eigen::Vector3d& p_map) const {
    return normal_map.dot(p_map - anchor_map) + offset_m;
  }
};

struct FloorNode {
  FloorId id;
  Eigen::Vector2d center_map = Eigen::Vector2d::Zero();
  bool has_height = false;
  double z_m = 0;  // height of the walking surface in map
  // False: only lifts have led here, and no measurement says how high over the first keyframe's floor it
  // lies. The map has put it somewhere clear of the others. Known in the output only.
  bool height_known = true;
};

// A room, an arm of a corridor. What does not follow from its centre is as it was last observed.
struct RoomNode {
  RoomId id;
  RoomObservation seen;
  Eigen::Vector2d center_map = Eigen::Vector2d::Zero();  // state
};

// A measurement that binds nodes.
struct RelativePoseFactor {
  int64_t id = 0;  // monotonic over all kinds of factors
  RelativePose measurement;
};

// A loop that was accepted and not withdrawn.
struct KnownLoop {
  RelativePose measurement;
  int64_t factor = -1;  // -1: switched off, as long as the rest of the graph contradicts it

  bool active() const { return factor >= 0; }
};

struct UpFactor {
  int64_t id = 0;
  KeyframeId keyframe;
  Eigen::Vector3d up_body = Eigen::Vector3d::UnitZ();
  double sigma_rad = 0;
};

// A plane seen from a keyframe.
struct ObservationFactor {
  int64_t id = 0;
  KeyframeId keyframe;
  PlaneId plane;
  PlaneObservation measurement;
};

// A plane that is level (horizontals) or plumb (verticals).
struct PlaneUpFactor {
  int64_t id = 0;
  PlaneId plane;
  bool level = false;
  double sigma_rad = 0;
};

// Two faces of one wall, antiparallel at a thickness of their own.
struct FacesFactor {
  int64_t id = 0;
  PlaneId a, b;
  double sigma_rad = 0;
};

// Two horizontals of one storey at one height.
struct SameHeightFactor {
  int64_t id = 0;
  PlaneId a, b;
  double sigma_m = 0;
};

// Whose centre: of a room or of a storey; the other is invalid.
struct CenterOf {
  RoomId room;
  FloorId floor;

  bool operator==(const CenterOf&) const = default;
};

// A centre halfway between two walls, as high as they were seen.
struct CenterWallsFactor {
  int64_t id = 0;
  CenterOf of;
  PlaneId a, b;
  bool finite = false;  // one of two pairs of a finite room
  double height_m = 0;
  double sigma_m = 0;
};

// A centre's place along a direction that its walls leave open, as a keyframe has it.
struct CenterAnchorFactor {
  int64_t id = 0;
  CenterOf of;
  KeyframeId keyframe;
  Eigen::Vector3d center_body = Eigen::Vector3d::Zero();
  Eigen::Vector3d along_body = Eigen::Vector3d::UnitX();
  double sigma_m = 0;
};

// Two walls of a room, parallel or at right angles.
struct RoomShapeFactor {
  int64_t id = 0;
  RoomId room;
  PlaneId a, b;
  bool square = false;
  double sigma_rad = 0;
};

// The height of a storey by a level plane.
struct FloorHeightFactor {
  int64_t id = 0;
  FloorId floor;
  PlaneId plane;
  double sigma_m = 0;
};

// A room of a storey.
struct FloorRoomFactor {
  int64_t id = 0;
  FloorId floor;
  RoomId room;
  Eigen::Vector2d offset_map = Eigen::Vector2d::Zero();  // of the room's centre from the storey's
  double sigma_m = 0;
};

// The layers and what binds them: plain data in ordered containers. Only the backend changes it.
struct SituationalGraph {
  std::map<KeyframeId, KeyframeNode> keyframes;
  std::map<PlaneId, PlaneNode> planes;
  std::map<PlaneId, PlaneId> merged_planes;  // planes that were found to be another, and where they live on
  std::map<RoomId, RoomNode> rooms;
  std::map<PassageId, Doorway> doorways;
  std::map<FloorId, FloorNode> floors;
  std::shared_ptr<const FreeSpace> free_space;        // as last observed; null: none yet
  Eigen::Vector3d up_map = Eigen::Vector3d::UnitZ();  // state on the unit sphere

  std::map<LoopId, KnownLoop> loops;

  std::vector<RelativePoseFactor> relative_poses;  // of loops the active ones
  std::vector<UpFactor> ups;
  std::vector<ObservationFactor> observations;
  std::vector<PlaneUpFactor> plane_ups;
  std::vector<FacesFactor> faces;
  std::vector<SameHeightFactor> same_heights;
  std::vector<CenterWallsFactor> center_walls;
  std::vector<CenterAnchorFactor> center_anchors;
  std::vector<RoomShapeFactor> room_shapes;
  std::vector<FloorHeightFactor> floor_heights;
  std::vector<FloorRoomFactor> floor_rooms;

  // SHA-256 of the canonical snapshot: nodes by layer and id, factors by kind and ids, doubles as IEEE bits.
  // The free space is no part of it: it is derived.
  std::string digest() const;

  // Throws std::logic_error if a factor names a node that does not exist or a pose is not finite.
  void check() const;
};

}  // namespace sgraphs
