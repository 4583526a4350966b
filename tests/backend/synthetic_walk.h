#pragma once

#include <random>
#include <vector>

#include "common/types/keyframe.h"

namespace sgraphs::testing_support {

struct WalkOptions {
  int num_keyframes = 300;
  uint32_t seed = 1;
  int loop_every = 0;       // 0: no loops
  bool neighbours = true;   // to k-2
  double up_sigma_rad = 0;  // 0: no up measurements
  double sigma_m = 0.01;    // of odometry, neighbours and loops, per axis
  double sigma_rad = 0.002;
  Eigen::Vector3d start_tilt = Eigen::Vector3d::Zero();  // rotation vector of the first body against level
};

struct Walk {
  std::vector<SE3> truth;           // T_world_body, world z up
  std::vector<Keyframe> keyframes;  // noise drawn from the very covariances that they state
};

// A random walk through a level building with gentle roll and pitch.
Walk makeWalk(const WalkOptions& options);

}  // namespace sgraphs::testing_support
