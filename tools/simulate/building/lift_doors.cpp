#include "tools/simulate/building/lift_doors.h"

#include <algorithm>
#include <cmath>

namespace sgraphs::simulate {
namespace {

constexpr uint8_t kDoorReflectivity = 60;  // brushed steel, as a painted wall
constexpr double kSameFloor_m = 1e-3;

}  // namespace

std::optional<RayHit> LiftDoorsNow::cast(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                                         double max_range_m) const {
  std::optional<RayHit> first;
  for (const Leaf& leaf : leaves_) {
    // origin + t u = a + s (b - a), seen from above.
    const Eigen::Vector2d along = leaf.b - leaf.a, d = leaf.a - origin.head<2>(), u = direction.head<2>();
    const double cross = u.x() * along.y() - u.y() * along.x();
    if (std::abs(cross) < 1e-12) continue;
    const double t = (d.x() * along.y() - d.y() * along.x()) / cross;
    const double s = (d.x() * u.y() - d.y() * u.x()) / cross;
    const double z = origin.z() + t * direction.z();
    if (t < 0 || s < 0 || s > 1 || z < leaf.z_min_m || z > leaf.z_max_m) continue;
    if (t > (first ? first->range_m : max_range_m)) continue;
    first = RayHit{t, std::min(1.0, std::abs(cross) / along.norm()), kDoorReflectivity};
  }
  return first;
}

LiftDoors::LiftDoors(const Scene& scene, const std::vector<Ride>& rides, double path_floor_z_m)
    : rides_(rides) {
  for (Ride& ride : rides_) {
    ride.from_m += path_floor_z_m;
    ride.to_m += path_floor_z_m;
  }
  for (size_t i = 0; i < scene.lifts.size(); ++i)
    for (const int floor : scene.lifts[i].floors) {
      const double z_m = scene.floors_z_m[static_cast<size_t>(floor)];
      doors_.push_back(
          {i, scene.lifts[i].door_a, scene.lifts[i].door_b, z_m, z_m + scene.lifts[i].door_height_m});
    }
}

double LiftDoors::openness(const Door& door, double seconds) const {
  const auto here = [&](double height_m) { return std::abs(height_m - door.z_min_m) < kSameFloor_m; };
  const Ride* last = nullptr;
  const Ride* next = nullptr;
  for (const Ride& ride : rides_) {
    if (ride.lift != door.lift) continue;
    if (ride.door_closes_s <= seconds) last = &ride;
    if (ride.door_closes_s > seconds && !next) next = &ride;
  }
  if (last && seconds < last->door_opens_s) {
    const double closing = (last->leaves_s - seconds) / (last->leaves_s - last->door_closes_s);
    const double opening = (seconds - last->arrives_s) / (last->door_opens_s - last->arrives_s);
    return std::clamp(std::max(here(last->from_m) ? closing : 0.0, here(last->to_m) ? opening : 0.0), 0.0,
                      1.0);
  }
  const bool goes = next && (!last || seconds > 0.5 * (last->door_opens_s + next->door_closes_s));
  return (goes && here(next->from_m)) || (!goes && last && here(last->to_m)) ? 1.0 : 0.0;
}

LiftDoorsNow LiftDoors::at(double seconds) const {
  LiftDoorsNow now;
  for (const Door& door : doors_) {
    const double open = openness(door, seconds);
    if (open >= 1) continue;
    const Eigen::Vector2d leaf = 0.5 * (1 - open) * (door.b - door.a);
    now.add({door.a, door.a + leaf, door.z_min_m, door.z_max_m});
    now.add({door.b, door.b - leaf, door.z_min_m, door.z_max_m});
  }
  return now;
}

TriangleMesh LiftDoors::closed() const {
  TriangleMesh mesh;
  const auto corner = [](const Eigen::Vector2d& xy, double z) { return Eigen::Vector3d(xy.x(), xy.y(), z); };
  for (const Door& door : doors_)
    mesh.addQuad({corner(door.a, door.z_min_m), corner(door.b, door.z_min_m), corner(door.b, door.z_max_m),
                  corner(door.a, door.z_max_m)},
                 kDoorReflectivity);
  return mesh;
}

}  // namespace sgraphs::simulate
