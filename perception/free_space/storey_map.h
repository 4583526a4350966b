#pragma once

#include <vector>

#include "perception/free_space/cell_box.h"
#include "perception/free_space/evidence_grid.h"
#include "perception/free_space/wall_cells.h"

namespace sgraphs {

// Free space of one storey: evidence, the two grids made of it, and their clearance.
class StoreyMap {
 public:
  static constexpr double kMaxCells =
      25e6;  // a quarter of a square kilometre; a pose gone wild costs no more

  StoreyMap(FloorId floor, const EvidenceConfig& config);

  // Whether a view around this place can be added: the grids are no larger than kMaxCells.
  bool reaches(const Eigen::Vector2d& position_map) const;
  // A keyframe's view with the height of the walking surface it stands on: added (sign 1) or taken back (-1).
  void add(const KeyframeView& view, double surface_z_m, int sign);
  void addWall(const WallTrace& trace, int sign);

  // Brings grids and clearance up to date with the evidence. True if a cell of either grid changed.
  bool refresh();

  // Both have the same layout. In `rooms` furniture, columns and small pockets are free: what divides rooms.
  // In `navigation` everything that stands in a robot's way is an obstacle.
  const StoreyGrid& rooms() const { return rooms_; }
  const StoreyGrid& navigation() const { return navigation_; }
  const EvidenceGrid& evidence() const { return evidence_; }
  bool knowsSurface() const { return num_views_ > 0; }
  double surface_z_m() const;
  size_t bytes() const;

 private:
  void grow(const std::set<EvidenceGrid::BlockKey>& blocks);
  void relayout(const CellBox& cells);
  // Classifies a block's columns into the raw states; what changed is added to the boxes.
  void classifyBlock(EvidenceGrid::BlockKey key, CellBox& rooms_changed, CellBox& navigation_changed);

  EvidenceConfig config_;
  EvidenceGrid evidence_;
  int64_t surface_sum_um_ = 0;  // over the views, in whole micrometres: taking back is exact
  int64_t num_views_ = 0;
  CellBox views_;  // cells of all views there ever were
  CellBox cells_;  // of the grids, in cells of the map
  StoreyGrid rooms_, navigation_;
  // By column as the votes have it, before islands are filled.
  std::vector<CellState> raw_rooms_, raw_navigation_;
  std::vector<uint8_t> on_wall_;
};

}  // namespace sgraphs
