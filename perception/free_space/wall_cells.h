#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "common/types/plane.h"
#include "perception/free_space/evidence_config.h"

namespace sgraphs {

// A mapped wall seen from above, where it stands at a given height: pieces of a line.
struct WallTrace {
  struct Piece {
    Eigen::Vector2d a_map = Eigen::Vector2d::Zero(), b_map = Eigen::Vector2d::Zero();
  };
  FloorId floor;
  std::vector<Piece> pieces;

  // No end lies farther from its counterpart: casting it again would change next to nothing.
  bool near(const WallTrace& other, double tolerance_m) const;
};

// The plane's trace at height z if it is vertical and as long as a wall; nothing for floors, columns,
// furniture.
std::optional<WallTrace> wallTrace(const MapPlane& plane, double z_m, const EvidenceConfig& config);

// Cells (x, y) whose centre lies within 1.2 cells of the piece, in order.
std::vector<std::pair<int, int>> wallCells(const WallTrace::Piece& piece, double cell_m);

}  // namespace sgraphs
