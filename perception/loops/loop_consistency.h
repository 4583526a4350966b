#pragma once

#include <cstdint>
#include <vector>

#include "perception/loops/walked_path.h"

namespace sgraphs {

// A return that was measured: T_from_to between an old and a newer keyframe.
struct MeasuredLoop {
  KeyframeId from;
  KeyframeId to;
  SE3 T_from_to;
  Matrix6d covariance = Matrix6d::Identity();
};

// Whether two loops can both be true: the cycle from one old place through its loop, along the newer path,
// back through the other loop and along the older path closes within what the odometry and the two
// measurements may err by.
bool consistent(const MeasuredLoop& a, const MeasuredLoop& b, const WalkedPath& path);

// Largest set of at most 64 nodes that are all joined to each other; bit j of neighbours[i]: i and j are
// joined. Of equally large ones that with the lowest nodes. Exact.
uint64_t largestClique(const std::vector<uint64_t>& neighbours);

}  // namespace sgraphs
