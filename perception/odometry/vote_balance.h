#pragma once

#include <vector>

#include "perception/odometry/surfel_map.h"

namespace sgraphs {

// What one patch of a scan says of the pose: the cell of the map that it meets and its weight [1/m^2].
struct PatchVote {
  const MapCell* cell = nullptr;  // none: it meets nothing
  double weight = 0;
};

// A factor of at most 1 for each vote. Along neither of the two horizontal directions that the scan knows
// best and worst may a single thing bring most of what is known: somebody who stands close by outweighs the
// far ends of a corridor tenfold, and takes the robot along when he walks off. What lies within half a metre
// of each other, seen from above, is one thing; it is cut to 0.3 of what all else brings, the strongest of at
// most three first. And what is wrong with a cell's plane is wrong for all patches that meet it: beside their
// own errors they have `cell_sigma_m` in common, so that together they weigh less than 1 / cell_sigma_m^2.
// A cabinet that is passed at half a metre meets a hundred patches of a scan. The map's z axis is up; all
// cells belong to one map.
std::vector<double> balanceVotes(const std::vector<PatchVote>& votes, double cell_sigma_m);

}  // namespace sgraphs
