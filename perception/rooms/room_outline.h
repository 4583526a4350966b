#pragma once

#include <vector>

#include "perception/rooms/line_cells.h"
#include "perception/rooms/wall_candidates.h"

namespace sgraphs {

struct OutlineCorner {
  Eigen::Vector2d position_map = Eigen::Vector2d::Zero();
  int line = -1;  // of the edge from this corner to the next
};

// A room's outline among its lines.
struct RoomOutline {
  std::vector<OutlineCorner> corners;  // simple, counter-clockwise; no two edges in a row on one line
  double covered_m2 = 0;               // of free space and furniture within
  double left_out_m2 = 0;              // of free space and furniture without
};

// How much of the edge from a to b, which has the room on its left, walls on this line stand along and face
// the room: high ones, and all [m].
struct WalledLength {
  double high_m = 0, all_m = 0;
};
WalledLength walledLength(const OutlineLine& line, const Eigen::Vector2d& a, const Eigen::Vector2d& b);

// The union of cells that agrees best with the free space, where an outline along walls costs nothing and any
// other boundary_cost_m per metre, along low furniture twice that; its largest connected part. Empty if there
// is none.
RoomOutline outlineOf(const ClusterBorder& border, const BorderEvidence& evidence, double boundary_cost_m);

}  // namespace sgraphs
