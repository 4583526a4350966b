#pragma once

#include <vector>

#include "perception/loops/place.h"
#include "perception/loops/wall_layout.h"

namespace sgraphs {

// Walls around the robot that are laid over the older ones [m].
inline constexpr double kQueryReach_m = 12.0;

// Upright patches from above, in the frame of the poses.
std::vector<WallPoint> wallsOf(const std::vector<PlacedPlace>& places);

// Those within kQueryReach_m of the origin, evenly thinned: walls about the body that the query's poses are
// given in, in a frame with z up at that body.
std::vector<WallPoint> wallsAround(std::vector<PlacedPlace> query, const Eigen::Quaterniond& R_level_body);

}  // namespace sgraphs
