#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "tools/simulate/building/ray_caster.h"
#include "tools/simulate/building/triangle_mesh.h"
#include "tools/simulate/scene/scene.h"
#include "tools/simulate/walk/trajectory.h"

namespace sgraphs::simulate {

// The leaves of lifts' doors at one instant, in the building's frame: upright rectangles without thickness.
class LiftDoorsNow {
 public:
  struct Leaf {
    Eigen::Vector2d a = Eigen::Vector2d::Zero();
    Eigen::Vector2d b = Eigen::Vector2d::Zero();
    double z_min_m = 0, z_max_m = 0;
  };

  bool empty() const { return leaves_.empty(); }
  const std::vector<Leaf>& leaves() const { return leaves_; }
  void add(const Leaf& leaf) { leaves_.push_back(leaf); }

  // First leaf along the ray.
  std::optional<RayHit> cast(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                             double max_range_m) const;

 private:
  std::vector<Leaf> leaves_;
};

// The doors of all lifts over the time of a walk. A car waits with its door open on the floor from which the
// walk's next ride begins, after the last ride on the floor where that ended; on all other floors the door is
// closed. Between two rides an empty car goes half-way through the time between, if it has to.
class LiftDoors {
 public:
  LiftDoors() = default;
  // `path_floor_z_m`: what the rides' heights are over.
  LiftDoors(const Scene& scene, const std::vector<Ride>& rides, double path_floor_z_m);

  bool empty() const { return doors_.empty(); }
  LiftDoorsNow at(double seconds) const;
  // All doors closed, as sheets: for a mesh of what may be seen.
  TriangleMesh closed() const;

 private:
  struct Door {
    size_t lift = 0;
    Eigen::Vector2d a = Eigen::Vector2d::Zero(), b = Eigen::Vector2d::Zero();
    double z_min_m = 0, z_max_m = 0;
  };
  // 0 closed, 1 open.
  double openness(const Door& door, double seconds) const;

  std::vector<Door> doors_;
  std::vector<Ride> rides_;  // heights in the building
};

}  // namespace sgraphs::simulate
