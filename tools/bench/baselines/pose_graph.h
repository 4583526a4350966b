#pragma once

#include <cstddef>
#include <vector>

#include "common/geometry/se3.h"

namespace sgraphs::bench {

struct PoseEdge {
  size_t from = 0;
  size_t to = 0;
  SE3 T_from_to;
  Matrix6d covariance = Matrix6d::Identity();  // of the right perturbation
  bool loop = false;                           // loops count through a Huber loss
};

// Poses with the least squared whitened residuals of all edges; the first one stays where it is.
std::vector<SE3> optimisePoses(const std::vector<SE3>& initial, const std::vector<PoseEdge>& edges);

}  // namespace sgraphs::bench
