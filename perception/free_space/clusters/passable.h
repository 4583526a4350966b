#pragma once

#include "perception/free_space/storey_grid.h"

namespace sgraphs {

// Whether anybody could walk through between two jambs, in map: in `navigation`, every line across the
// passage, a little before and behind it too, leaves a gap. A window has a wall below.
bool isPassable(const StoreyGrid& navigation, const Eigen::Vector2d& left, const Eigen::Vector2d& right);

}  // namespace sgraphs
