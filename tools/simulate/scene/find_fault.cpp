#include "tools/simulate/scene/find_fault.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "tools/simulate/building/building.h"

namespace sgraphs::simulate {
namespace {

constexpr double kSample_m = 0.02;  // along the path, between checks of the clearance

std::string text(double value) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%.4g", value);
  return buffer;
}

std::string text(const Eigen::Vector2d& xy) {
  return "(" + text(xy.x()) + ", " + text(xy.y()) + ")";
}

std::string item(const char* list, size_t index) {
  return std::string(list) + "[" + std::to_string(index) + "]";
}

// What stands in the way of a body that walks on the path's floor.
struct Obstacle {
  std::string name;
  Box box;
};

// Distance from the box's footprint; 0 inside.
double distanceTo(const Box& box, const Eigen::Vector2d& xy) {
  const Eigen::Vector2d d = xy - box.center;
  const double c = std::cos(box.yaw_rad), s = std::sin(box.yaw_rad);
  const Eigen::Vector2d own(std::abs(c * d.x() + s * d.y()), std::abs(c * d.y() - s * d.x()));
  return (own - 0.5 * box.size).cwiseMax(0.0).norm();
}

std::vector<Obstacle> obstaclesOf(const Scene& scene) {
  // The band that the body and its LiDAR sweep.
  const double floor = scene.floors_z_m[static_cast<size_t>(scene.path_floor)];
  const double low = floor + 0.05, high = floor + scene.path.body_height_m + 0.5;
  std::vector<Obstacle> obstacles;
  for (size_t i = 0; i < scene.walls.size(); ++i)
    for (const WallPart& part : wallParts(scene.walls[i], scene.doorways))
      obstacles.push_back({item("walls", i), boxOf(scene.walls[i], part)});
  for (size_t i = 0; i < scene.boxes.size(); ++i) {
    const std::string& name = scene.boxes[i].name;
    obstacles.push_back(
        {name.empty() ? item("boxes", i) : item("boxes", i) + " '" + name + "'", scene.boxes[i]});
  }
  std::erase_if(obstacles, [&](const Obstacle& o) { return o.box.z_min_m > high || o.box.z_max_m < low; });
  return obstacles;
}

const Obstacle* nearest(const std::vector<Obstacle>& obstacles, const Eigen::Vector2d& xy, double& distance) {
  const Obstacle* found = nullptr;
  for (const Obstacle& obstacle : obstacles) {
    const double d = distanceTo(obstacle.box, xy);
    if (found && d >= distance) continue;
    found = &obstacle;
    distance = d;
  }
  return found;
}

std::optional<std::string> wallFault(const Scene& scene) {
  for (size_t i = 0; i < scene.walls.size(); ++i) {
    const Wall& wall = scene.walls[i];
    if (wall.length() < 1e-3)
      return item("walls", i) + " has no length: its ends a and b are both " + text(wall.a);
    if (!(wall.thickness_m > 0))
      return item("walls", i) + " has a thickness of " + text(wall.thickness_m) + " m: it must be positive";
    if (!(wall.z_max_m > wall.z_min_m))
      return item("walls", i) + " has no height: z runs from " + text(wall.z_min_m) + " to " +
             text(wall.z_max_m);
  }
  return std::nullopt;
}

std::optional<std::string> doorwayFault(const Scene& scene) {
  for (size_t i = 0; i < scene.doorways.size(); ++i) {
    const Doorway& doorway = scene.doorways[i];
    if (!(doorway.width_m > 0) || !(doorway.height_m > 0))
      return item("doorways", i) + " must have a positive width and height";
    bool on_wall = false;
    for (const Wall& wall : scene.walls) on_wall |= openingOf(doorway, wall).has_value();
    if (!on_wall)
      return item("doorways", i) + " at " + text(Eigen::Vector2d(doorway.xyz.head<2>())) + ", " +
             text(doorway.width_m) +
             " m wide, is not on a wall that holds it: put it on a wall's centre line";
  }
  return std::nullopt;
}

std::optional<std::string> otherFault(const Scene& scene) {
  for (size_t i = 0; i < scene.boxes.size(); ++i) {
    const Box& box = scene.boxes[i];
    if (!(box.size.minCoeff() > 0) || !(box.z_max_m > box.z_min_m))
      return item("boxes", i) + " must have a positive size and height";
  }
  for (size_t i = 0; i < scene.slabs.size(); ++i) {
    const Slab& slab = scene.slabs[i];
    if (!((slab.max - slab.min).minCoeff() > 0) || !(slab.z_max_m > slab.z_min_m))
      return item("slabs", i) + " must have max above min in x, y and z";
  }
  for (size_t i = 0; i < scene.rooms.size(); ++i)
    if (scene.rooms[i].polygon.size() < 3)
      return item("rooms", i) + " '" + scene.rooms[i].id + "' needs a polygon of at least 3 corners";
  return std::nullopt;
}

std::optional<std::string> waypointFault(const Scene& scene, const std::vector<Obstacle>& obstacles) {
  const auto& points = scene.path.waypoints;
  for (size_t i = 0; i < points.size(); ++i) {
    double distance = 0;
    const Obstacle* obstacle = nearest(obstacles, points[i].xy, distance);
    const std::string where = item("path.waypoints", i) + " at " + text(points[i].xy);
    if (obstacle && distance <= 0) return where + " lies inside " + obstacle->name + ": move it";
    if (obstacle && distance < scene.path.clearance_m)
      return where + " is " + text(distance) + " m from " + obstacle->name + ": keep " +
             text(scene.path.clearance_m) + " m";
    if (i > 0 && (points[i].xy - points[i - 1].xy).norm() < 1e-3)
      return where + " is the same as the one before: remove one, and use pause_s to stand";
  }
  return std::nullopt;
}

std::optional<std::string> passageFault(const Scene& scene, const std::vector<Obstacle>& obstacles) {
  const auto blocked = [&](const Eigen::Vector2d& xy, const std::string& what) -> std::optional<std::string> {
    double distance = 0;
    const Obstacle* obstacle = nearest(obstacles, xy, distance);
    if (!obstacle || distance >= scene.path.clearance_m) return std::nullopt;
    return what + " at " + text(xy) +
           (distance <= 0 ? " goes through " : " is " + text(distance) + " m from ") + obstacle->name +
           ": keep " + text(scene.path.clearance_m) + " m";
  };
  const auto& points = scene.path.waypoints;
  for (size_t i = 0; i + 1 < points.size(); ++i) {
    const Eigen::Vector2d leg = points[i + 1].xy - points[i].xy;
    const int steps = static_cast<int>(std::ceil(leg.norm() / kSample_m));
    for (int k = 1; k < steps; ++k)
      if (auto fault =
              blocked(points[i].xy + leg * (static_cast<double>(k) / steps),
                      "the path from " + item("path.waypoints", i) + " to " + item("path.waypoints", i + 1)))
        return fault;
  }
  // Arcs leave the legs.
  const Trajectory walk = walkAlong(scene.path, Time{}, 0);
  const double seconds = walk.duration().seconds();
  const int samples = static_cast<int>(std::ceil(seconds * scene.path.speed_mps / kSample_m));
  for (int k = 0; k <= samples; ++k) {
    const SE3 T = walk.poseAtOffset(seconds * k / std::max(1, samples));
    if (auto fault = blocked(T.translation.head<2>(), "the walk, which rounds corners,")) return fault;
  }
  return std::nullopt;
}

}  // namespace

std::optional<std::string> findFault(const Scene& scene) {
  if (scene.walls.empty() && scene.slabs.empty()) return "there is neither a wall nor a slab: give walls";
  if (auto fault = wallFault(scene)) return fault;
  if (auto fault = doorwayFault(scene)) return fault;
  if (auto fault = otherFault(scene)) return fault;
  if (scene.path.waypoints.empty()) return "path.waypoints is empty: give at least one waypoint [x, y]";
  const auto obstacles = obstaclesOf(scene);
  if (auto fault = waypointFault(scene, obstacles)) return fault;
  return passageFault(scene, obstacles);
}

}  // namespace sgraphs::simulate
