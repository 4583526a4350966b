#pragma once

#include <vector>

#include "common/types/keyframe.h"
#include "common/types/plane.h"
#include "tests/backend/planes/plane_world.h"

namespace sgraphs::testing_support {

struct RingOptions {
  double laps = 1.3;
  double step_m = 0.8;
  double start_heading_rad = 0;  // of the building against the body at the start
  double sigma_m = 0.01;         // of odometry, per axis and keyframe
  double sigma_rad = 0.003;
  double wall_off_square_rad = 0;  // one outer wall turned by this
  bool floor_and_ceiling = true;
  uint32_t seed = 1;
};

// A square corridor, 16 m outside and 12 m inside, 2.6 m high, walked along its middle. Odometry and planes
// carry independent noise of the covariances they state.
struct RingWalk {
  std::vector<Face> faces;
  std::vector<SE3> truth;  // T_world_body; the map's frame is that of the first body, level
  std::vector<Keyframe> keyframes;
  std::vector<KeyframePlanes> planes;

  SE3 T_map_world() const { return truth.front().inverse(); }
};

RingWalk makeRingWalk(const RingOptions& options);

}  // namespace sgraphs::testing_support
