#pragma once

#include <cstdint>
#include <vector>

#include "common/base/ids.h"
#include "common/base/time.h"
#include "common/geometry/se3.h"
#include "common/types/plane.h"

namespace sgraphs {

// A keyframe of the map as GRAPH_UPDATE tells it to the other stages.
struct MapKeyframe {
  KeyframeId id;
  FloorId floor;  // invalid while the robot is between storeys
  Time time;      // end of the keyframe's scan
  SE3 T_map_body;
};

// What a round changed: nodes that are new or moved by more than a millimetre or 0.1 mrad, by id. A stage
// that applies one after the other holds the backend's map.
struct MapUpdate {
  int64_t round = 0;
  Time time;          // sensor time of the round
  KeyframeId newest;  // newest keyframe; invalid: none yet
  bool idle = false;  // the round had no keyframe
  // Of the newest keyframe's T_map_body, conservative; tangent of body.
  Matrix6d newest_covariance = Matrix6d::Zero();
  std::vector<MapKeyframe> keyframes;
  std::vector<MapPlane> planes;
};

}  // namespace sgraphs
