#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "common/types/plane.h"
#include "perception/free_space/evidence_config.h"

namespace sgraphs {

// A mapped wall seen from above: a line with a normal.
struct WallLine {
  FloorId floor;
  Eigen::Vector2d a_map = Eigen::Vector2d::Zero();
  Eigen::Vector2d b_map = Eigen::Vector2d::Zero();
  double top_z_m = 0;

  // Nearer than a fraction of a cell, so that casting it again would change next to nothing.
  bool near(const WallLine& other, double tolerance_m) const;
};

// The plane's line if it is vertical and as long as a wall; nothing for floors, columns, furniture.
std::optional<WallLine> wallLine(const MapPlane& plane, const EvidenceConfig& config);

// Cells (x, y) whose centre lies within 1.2 cells of the line, in order.
std::vector<std::pair<int, int>> wallCells(const WallLine& line, double cell_m);

}  // namespace sgraphs
