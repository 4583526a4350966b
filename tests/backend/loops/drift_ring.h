#pragma once

#include <vector>

#include "common/types/keyframe.h"
#include "common/types/loops.h"
#include "common/types/plane.h"
#include "tests/backend/planes/plane_world.h"

namespace sgraphs::testing_support {

struct DriftRingOptions {
  double side_m = 40;  // of the ring, along the middle of the corridor
  double laps = 1.2;
  double step_m = 0.8;
  // As legs err: too long a step, and a turn for each metre. Walls would tell; see open_m.
  double scale_bias = 0.002;  // no loop tells the scale of a ring that closes
  double yaw_bias_rad_per_m = 0.0045;
  double open_m = 14;  // in the middle of each side no wall is in sight
  uint32_t seed = 1;
};

// A square ring of corridors 2 m wide with niches, walked along its middle. Odometry drifts by metres in a
// lap where no wall is in sight: its covariances cover the bias, and its noise is less. Planes carry noise of
// the covariances they state.
struct DriftRing {
  std::vector<Face> faces;
  std::vector<SE3> truth;  // T_world_body
  std::vector<Keyframe> keyframes;
  std::vector<KeyframePlanes> planes;

  SE3 T_map_world() const { return truth.front().inverse(); }
  // A true loop from a keyframe of the first lap near `to`, with noise; `id` gives the noise.
  LoopClosure loop(KeyframeId to, LoopId id) const;
};

DriftRing makeDriftRing(const DriftRingOptions& options);

}  // namespace sgraphs::testing_support
