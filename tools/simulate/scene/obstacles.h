#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "tools/simulate/scene/scene.h"

namespace sgraphs::simulate {

// Where a walking body is: its place, and the height of the surface that it walks on.
struct Foothold {
  Eigen::Vector2d xy = Eigen::Vector2d::Zero();
  double z_m = 0;
};

// What may stand in the way of a body.
class Obstacles {
 public:
  explicit Obstacles(const Scene& scene);

  struct Nearest {
    std::string name;  // empty: nothing within the path's clearance
    double distance_m = 0;
  };
  // What comes nearest to a body there, within the path's clearance.
  Nearest nearest(const Foothold& at) const;

 private:
  // Upright solid over a rectangle, rounded by `radius_m`; a column has a rectangle of no size.
  struct Solid {
    std::string name;
    Eigen::Vector2d center, axis, half_size;
    double radius_m;
    double z_min_m, z_max_m;
    double reach_m;   // half of its diagonal and the clearance: no farther body can be in its way
    int flight = -1;  // index of the flight of stairs that it is a step of
    bool slab = false;
  };

  void add(const std::string& name, const Box& box, bool slab = false, int flight = -1);
  void addColumn(const std::string& name, const Column& column);
  void addFlight(const std::string& name, const Stairs& stairs, int index);
  bool inTheWay(const Solid& solid, const Foothold& at) const;

  double clearance_m_;
  double body_top_m_;  // over the walking surface, with the LiDAR
  std::vector<Stairs> flights_;
  std::vector<Solid> solids_;
};

// Height of the flight's slope, which its steps' back edges touch, at this place, if the place is on the
// flight or at most `margin_m` before its foot or behind its top; else nothing.
std::optional<double> slopeHeight(const Stairs& stairs, const Eigen::Vector2d& xy, double margin_m);

}  // namespace sgraphs::simulate
