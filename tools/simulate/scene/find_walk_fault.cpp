#include "tools/simulate/scene/find_walk_fault.h"

#include <algorithm>
#include <cmath>

#include "tools/simulate/building/building.h"
#include "tools/simulate/scene/fault_text.h"
#include "tools/simulate/scene/obstacles.h"

namespace sgraphs::simulate {
namespace {

using Fault = std::optional<std::string>;

constexpr double kSample_m = 0.02;      // along the path, between checks of the clearance
constexpr double kSteepest = 1.2;       // rise per distance: 50 degrees
constexpr double kHighestStep_m = 0.3;  // between the walking surface and what carries it

double floorOf(const Scene& scene) {
  return scene.floors_z_m[static_cast<size_t>(scene.path_floor)];
}

Foothold footholdOf(const Scene& scene, const Waypoint& waypoint) {
  return {waypoint.xy, floorOf(scene) + waypoint.rise_m + waypoint.ridden_m};
}

std::string nameOf(size_t waypoint, const Foothold& at) {
  return item("path.waypoints", waypoint) + " at " + text(at.xy);
}

// Whether a floor, a flight of stairs, a slab or a box lies under the feet.
bool carried(const Scene& scene, const Foothold& at) {
  const auto level = [&](double z_m) { return std::abs(z_m - at.z_m) <= kHighestStep_m; };
  if (std::any_of(scene.floors_z_m.begin(), scene.floors_z_m.end(), level)) return true;
  for (const Stairs& stairs : scene.stairs)
    if (const auto z_m = slopeHeight(stairs, at.xy, 0); z_m && level(*z_m)) return true;
  for (const Slab& slab : slabsOf(scene))
    if (level(slab.z_max_m) && (at.xy - slab.min).minCoeff() >= 0 && (slab.max - at.xy).minCoeff() >= 0)
      return true;
  return std::any_of(scene.boxes.begin(), scene.boxes.end(), [&](const Box& box) {
    return level(box.z_max_m) && (at.xy - box.center).norm() <= 0.5 * box.size.norm();
  });
}

Fault waypointFault(const Scene& scene, const Obstacles& obstacles) {
  const auto& points = scene.path.waypoints;
  for (size_t i = 0; i < points.size(); ++i) {
    const Foothold at = footholdOf(scene, points[i]);
    if (!at.xy.allFinite() || !std::isfinite(at.z_m))
      return item("path.waypoints", i) + " must hold finite numbers";
    const std::string where = nameOf(i, at);
    const auto obstacle = obstacles.nearest(at);
    if (!obstacle.name.empty() && obstacle.distance_m <= 0)
      return where + " lies inside " + obstacle.name + ": move it";
    if (!obstacle.name.empty())
      return where + " is " + text(obstacle.distance_m) + " m from " + obstacle.name + ": keep " +
             text(scene.path.clearance_m) + " m";
    if (i > 0 && (points[i].xy - points[i - 1].xy).norm() < 1e-3)
      return where + " is the same as the one before: remove one, and use pause_s to stand";
    if (scene.meshes.empty() && !carried(scene, at))
      return where + " stands at z = " + text(at.z_m) +
             " in the air: put it on a floor, a flight of stairs or a slab";
  }
  return std::nullopt;
}

Fault slopeFault(const Scene& scene) {
  const auto& points = scene.path.waypoints;
  for (size_t i = 0; i + 1 < points.size(); ++i) {
    const double rise = points[i + 1].rise_m - points[i].rise_m;
    const double length = (points[i + 1].xy - points[i].xy).norm();
    if (std::abs(rise) > kSteepest * length)
      return "the path from " + item("path.waypoints", i) + " to " + item("path.waypoints", i + 1) +
             (rise > 0 ? " rises" : " falls") + " by " + text(std::abs(rise)) + " m over " + text(length) +
             " m: give z to waypoints at the foot and the top of a slope of at most 50 degrees";
  }
  return std::nullopt;
}

Fault passageFault(const Scene& scene, const Obstacles& obstacles) {
  const auto blocked = [&](const Foothold& at, const std::string& what) -> Fault {
    const auto obstacle = obstacles.nearest(at);
    if (obstacle.name.empty()) return std::nullopt;
    return what + " at " + text(at.xy) +
           (obstacle.distance_m <= 0 ? " goes through " : " is " + text(obstacle.distance_m) + " m from ") +
           obstacle.name + ": keep " + text(scene.path.clearance_m) + " m";
  };
  const auto& points = scene.path.waypoints;
  for (size_t i = 0; i + 1 < points.size(); ++i) {
    const Foothold to = footholdOf(scene, points[i + 1]);
    Foothold from = footholdOf(scene, points[i]);
    from.z_m += points[i].ride_m;
    const int samples = static_cast<int>(std::ceil((to.xy - from.xy).norm() / kSample_m));
    for (int k = 0; k <= samples; ++k) {
      const double share = static_cast<double>(k) / samples;
      const Foothold at{from.xy + share * (to.xy - from.xy), from.z_m + share * (to.z_m - from.z_m)};
      if (auto fault = blocked(
              at, "the path from " + item("path.waypoints", i) + " to " + item("path.waypoints", i + 1)))
        return fault;
    }
  }
  // Arcs leave the legs.
  WalkPath without_gait = scene.path;
  without_gait.gait = {0, 0, 0, 0, 0, 0};
  const Trajectory walk = walkAlong(without_gait, Time{}, floorOf(scene));
  const double seconds = walk.duration().seconds();
  const int samples = static_cast<int>(std::ceil(seconds * scene.path.speed_mps / kSample_m));
  for (int k = 0; k <= samples; ++k) {
    const Eigen::Vector3d body = walk.seenPoseAtOffset(seconds * k / std::max(1, samples)).translation;
    const Foothold at{body.head<2>(), body.z() - scene.path.body_height_m};
    if (auto fault = blocked(at, "the walk, which rounds corners,")) return fault;
  }
  return std::nullopt;
}

}  // namespace

Fault findWalkFault(const Scene& scene) {
  if (scene.path.waypoints.empty()) return "path.waypoints is empty: give at least one waypoint [x, y]";
  const Obstacles obstacles(scene);
  if (auto fault = waypointFault(scene, obstacles)) return fault;
  if (auto fault = slopeFault(scene)) return fault;
  return passageFault(scene, obstacles);
}

}  // namespace sgraphs::simulate
