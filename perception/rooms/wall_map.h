#pragma once

#include <Eigen/Core>
#include <map>
#include <optional>

#include "common/types/map_update.h"

namespace sgraphs {

// An upright plane seen from above. The side it was seen from, where rooms are, is left of `along`.
struct Wall {
  PlaneId id;
  Eigen::Vector2d normal = Eigen::Vector2d::UnitX();  // unit, in map; normal.p + d = 0
  double d = 0;
  Eigen::Vector2d along = -Eigen::Vector2d::UnitY();  // unit
  double begin_m = 0, end_m = 0;                      // extent: along.p, begin <= end
  double bottom_z_m = 0, top_z_m = 0;
  bool low = false;      // furniture, or a parapet, as its storey tells
  int64_t changed = 0;   // counts the changes of all planes: another value, another wall
  int64_t keyframe = 0;  // keyframes of the map when it last changed

  double distance(const Eigen::Vector2d& p) const { return normal.dot(p) + d; }
  Eigen::Vector2d pointAt(double s) const { return s * along - d * normal; }
  double length() const { return end_m - begin_m; }
};

// A plane as a wall; none if it is not upright or has no extent.
std::optional<Wall> wallOf(const MapPlane& plane);

// The backend's map as MapUpdates have told it: planes and keyframes.
class WallMap {
 public:
  void apply(const MapUpdate& update);

  const std::map<PlaneId, Wall>& walls() const { return walls_; }
  const std::map<PlaneId, MapPlane>& levelPlanes() const { return level_planes_; }
  const std::map<KeyframeId, MapKeyframe>& keyframes() const { return keyframes_; }
  // Where a plane lives on.
  PlaneId resolve(PlaneId id) const;
  // Changed within the last `window` keyframes; 0: always.
  bool isRecent(const Wall& wall, int window) const;

 private:
  void apply(const MapPlane& plane);

  std::map<PlaneId, Wall> walls_;
  std::map<PlaneId, MapPlane> level_planes_;
  std::map<PlaneId, PlaneId> merged_;
  std::map<KeyframeId, MapKeyframe> keyframes_;
  int64_t changes_ = 0;
};

}  // namespace sgraphs
