#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "tools/simulate/building/ray_caster.h"
#include "tools/simulate/scene/scene.h"

namespace sgraphs::simulate {

// Part of a body: an upright cylinder.
struct UprightCylinder {
  Eigen::Vector2d center = Eigen::Vector2d::Zero();
  double radius_m = 0;
  double z_min_m = 0;
  double z_max_m = 0;
};

// Where a ray from outside enters the closed cylinder; `direction` is a unit vector.
std::optional<RayHit> intersect(const UprightCylinder& cylinder, const Eigen::Vector3d& origin,
                                const Eigen::Vector3d& direction, uint8_t reflectivity);

// People at one instant, in the building's frame.
class PeopleNow {
 public:
  struct Body {
    Eigen::Vector2d center = Eigen::Vector2d::Zero();
    double reach_m = 0;                    // radius of an upright cylinder around all parts
    std::array<UprightCylinder, 4> parts;  // two legs, trunk, head
  };

  bool empty() const { return bodies_.empty(); }
  const std::vector<Body>& bodies() const { return bodies_; }
  void add(const Body& body) { bodies_.push_back(body); }

  // First body along the ray.
  std::optional<RayHit> cast(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                             double max_range_m) const;

 private:
  std::vector<Body> bodies_;
};

// People who walk to and fro along lines at even speed, turn in no time, and move their legs with the
// distance walked. Where they are depends on the time alone.
class People {
 public:
  People() = default;
  People(const std::vector<Person>& people, const std::vector<double>& floors_z_m);

  bool empty() const { return walkers_.empty(); }
  PeopleNow at(double seconds) const;

 private:
  struct Walker {
    Person person;
    double floor_z_m = 0;
    std::vector<double> distance_m;  // of each waypoint from the first, along the line
  };

  static PeopleNow::Body bodyOf(const Walker& walker, double seconds);

  std::vector<Walker> walkers_;
};

}  // namespace sgraphs::simulate
