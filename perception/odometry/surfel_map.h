#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "perception/odometry/surfel.h"
#include "perception/odometry/voxel_index.h"

namespace sgraphs {

// One cell of the map: the distribution of the points on one face of one surface.
struct MapCell {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();     // in the map's frame
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();   // unit, towards those who saw it
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();  // sum of outer products about the mean [m^2]
  double count = 0;                                   // points behind it
  double variance_m2 = 0;                             // of the mean along the normal
  double tilt_variance = 0;                           // of the normal, per radian^2, worst direction
  uint64_t key = 0;

  void visitState(auto& archive) { archive(mean, normal, scatter, count, variance_m2, tilt_variance, key); }
};

// The voxels of VGICP, split by the side from which a surface was seen: a cell belongs to a cube and to one
// of six facing directions. The two faces of a thin wall, or the walls and the floor of a corner, thus never
// mix into one distribution, and a registration against the distribution's plane has no bias where surfaces
// meet. A surface close to a cube's border would be cut in two halves of its own noise; so a patch looks for
// its surface in the cubes before and behind it along the facing axis too.
class SurfelMap {
 public:
  explicit SurfelMap(double cell_m = 1) : cell_m_(cell_m) {}

  // Adds a patch moved by T_map_body: merged into the surface it lies on (closer than `merge_m`), else a new
  // cell.
  void insert(const Surfel& surfel, const SE3& T_map_body, double merge_m);

  // Cell with the nearest surface to the point that faces the same way; nullptr if none is within gate_m and
  // max_angle (given as its cosine) or all are too young to know their plane.
  const MapCell* match(const Eigen::Vector3d& point, const Eigen::Vector3d& normal, double gate_m,
                       double min_cos) const;

  // Forgets cells farther than radius_m from the centre.
  void prune(const Eigen::Vector3d& centre, double radius_m);

  void visitState(auto& archive) { archive(cell_m_, cells_, index_); }

  size_t size() const { return cells_.size(); }
  bool empty() const { return cells_.empty(); }
  const std::vector<MapCell>& cells() const { return cells_; }

 private:
  struct Address {
    Eigen::Vector3i cube;
    int axis;
    uint64_t facing;  // 2 * axis + (normal negative on that axis)
  };
  // The cube and facing of a patch; a second facing where the normal lies between two axes (walls at 45
  // degrees), so that noise of the normal does not split one surface in two.
  struct Addresses {
    Address at[2];
    int count;
  };
  Addresses addressesOf(const Eigen::Vector3d& point, const Eigen::Vector3d& normal) const;
  int32_t find(Address address, int step) const;
  // Nearest cell among the addresses and their neighbours along the facing axis that `usable` accepts; -1:
  // none.
  template <typename Usable>
  int32_t nearest(const Addresses& addresses, const Eigen::Vector3d& point, double within_m,
                  Usable usable) const;

  double cell_m_;
  std::vector<MapCell> cells_;
  VoxelIndex index_;
};

}  // namespace sgraphs
