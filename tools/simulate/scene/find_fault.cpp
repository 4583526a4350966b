#include "tools/simulate/scene/find_fault.h"

#include <algorithm>
#include <string>
#include <vector>

#include "tools/simulate/building/building.h"
#include "tools/simulate/scene/fault_text.h"
#include "tools/simulate/scene/find_walk_fault.h"

namespace sgraphs::simulate {
namespace {

using Fault = std::optional<std::string>;

constexpr int kMostSteps = 1000;
constexpr double kDoorInDoorway_m = 0.2;  // between the middles of a lift's door and its doorway

// Whether the item has a height; if not, what to say.
Fault heightFault(const std::string& name, double z_min_m, double z_max_m) {
  if (z_max_m > z_min_m) return std::nullopt;
  return name + " has no height: z runs from " + text(z_min_m) + " to " + text(z_max_m);
}

Fault wallFault(const Scene& scene) {
  for (size_t i = 0; i < scene.walls.size(); ++i) {
    const Wall& wall = scene.walls[i];
    if (!(wall.length() >= 1e-3))
      return item("walls", i) + " has no length: its ends a and b are both " + text(wall.a);
    if (!(wall.thickness_m > 0))
      return item("walls", i) + " has a thickness of " + text(wall.thickness_m) + " m: it must be positive";
    if (auto fault = heightFault(item("walls", i), wall.z_min_m, wall.z_max_m)) return fault;
  }
  return std::nullopt;
}

// A doorway or a window.
template <typename Item>
Fault openingFault(const Scene& scene, const std::string& name, const Item& opening) {
  if (!(opening.width_m > 0) || !(opening.height_m > 0))
    return name + " must have a positive width and height";
  const auto holds = [&](const Wall& wall) { return openingOf(opening, wall).has_value(); };
  if (std::any_of(scene.walls.begin(), scene.walls.end(), holds)) return std::nullopt;
  return name + " at " + text(Eigen::Vector2d(opening.xyz.template head<2>())) + ", z " +
         text(opening.xyz.z()) + ", " + text(opening.width_m) + " m wide and " + text(opening.height_m) +
         " m high, is not on a wall that holds it: put it on a wall's centre line";
}

Fault openingsFault(const Scene& scene) {
  for (size_t i = 0; i < scene.doorways.size(); ++i)
    if (auto fault = openingFault(scene, item("doorways", i), scene.doorways[i])) return fault;
  for (size_t i = 0; i < scene.windows.size(); ++i)
    if (auto fault = openingFault(scene, item("windows", i), scene.windows[i])) return fault;
  return std::nullopt;
}

Fault stairsFault(const Stairs& stairs, const std::string& name) {
  if (!((stairs.top - stairs.foot).norm() >= 1e-3))
    return name + " has no length: its foot and top are both " + text(stairs.foot);
  if (!(stairs.width_m > 0))
    return name + " has a width of " + text(stairs.width_m) + " m: it must be positive";
  if (stairs.steps < 1 || stairs.steps > kMostSteps)
    return name + " has " + std::to_string(stairs.steps) + " steps: give 1 to " + std::to_string(kMostSteps);
  return heightFault(name, stairs.z_min_m, stairs.z_max_m);
}

Fault solidsFault(const Scene& scene) {
  for (size_t i = 0; i < scene.boxes.size(); ++i) {
    const Box& box = scene.boxes[i];
    if (!(box.size.minCoeff() > 0) || !(box.z_max_m > box.z_min_m))
      return item("boxes", i) + " must have a positive size and height";
  }
  for (size_t i = 0; i < scene.columns.size(); ++i) {
    const Column& column = scene.columns[i];
    if (!(column.radius_m > 0))
      return item("columns", i) + " has a radius of " + text(column.radius_m) + " m: it must be positive";
    if (auto fault = heightFault(item("columns", i), column.z_min_m, column.z_max_m)) return fault;
  }
  for (size_t i = 0; i < scene.stairs.size(); ++i)
    if (auto fault = stairsFault(scene.stairs[i], item("stairs", i))) return fault;
  for (size_t i = 0; i < scene.slabs.size(); ++i) {
    const Slab& slab = scene.slabs[i];
    if (!((slab.max - slab.min).minCoeff() > 0) || !(slab.z_max_m > slab.z_min_m))
      return item("slabs", i) + " must have max above min in x, y and z";
  }
  return std::nullopt;
}

Fault liftsFault(const Scene& scene) {
  for (size_t i = 0; i < scene.lifts.size(); ++i) {
    const Lift& lift = scene.lifts[i];
    const std::string name = item("lifts", i);
    if (lift.floors.size() < 2) return name + " stops on fewer than two floors: list two or more";
    if (!((lift.door_b - lift.door_a).norm() >= 1e-3))
      return name + " has a door without width: its ends are both " + text(lift.door_a);
    const Eigen::Vector2d middle = 0.5 * (lift.door_a + lift.door_b);
    for (const int floor : lift.floors)
      if (std::none_of(scene.doorways.begin(), scene.doorways.end(), [&](const Doorway& doorway) {
            return doorway.floor == floor && (doorway.xyz.head<2>() - middle).norm() < kDoorInDoorway_m;
          }))
        return name + " has a door at " + text(middle) + " where floor " + std::to_string(floor) +
               " has no doorway: give it one";
  }
  return std::nullopt;
}

Fault peopleFault(const Scene& scene) {
  for (size_t i = 0; i < scene.people.size(); ++i) {
    const Person& person = scene.people[i];
    const std::string name = item("people", i);
    if (person.waypoints.empty())
      return name + " has no waypoints: give one to stand at, or several to walk to and fro between";
    for (size_t k = 0; k < person.waypoints.size(); ++k) {
      if (!person.waypoints[k].allFinite())
        return name + item(".waypoints", k) + " must be two finite numbers";
      if (k > 0 && !((person.waypoints[k] - person.waypoints[k - 1]).norm() >= 1e-3))
        return name + item(".waypoints", k) + " is the same as the one before: remove one";
    }
    if (!(person.speed_mps > 0) && person.waypoints.size() > 1)
      return name + " has a speed of " + text(person.speed_mps) + " m/s: it must be positive";
    if (!(person.radius_m > 0) || !(person.height_m > 0))
      return name + " must have a positive radius and height";
  }
  return std::nullopt;
}

Fault roomsFault(const Scene& scene) {
  for (size_t i = 0; i < scene.rooms.size(); ++i)
    if (scene.rooms[i].polygon.size() < 3)
      return item("rooms", i) + " '" + scene.rooms[i].id + "' needs a polygon of at least 3 corners";
  return std::nullopt;
}

}  // namespace

Fault findFault(const Scene& scene) {
  if (scene.walls.empty() && scene.slabs.empty() && scene.meshes.empty())
    return "there is neither a wall nor a slab nor a mesh: give walls";
  for (const auto& find :
       {wallFault, openingsFault, solidsFault, liftsFault, peopleFault, roomsFault, findWalkFault})
    if (auto fault = find(scene)) return fault;
  return std::nullopt;
}

}  // namespace sgraphs::simulate
