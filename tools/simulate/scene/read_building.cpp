#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "common/geometry/degree.h"
#include "tools/simulate/scene/read_scene.h"

namespace sgraphs::simulate {
namespace {

constexpr double kFar_m = 10000;  // no building is larger

std::pair<double, double> zRange(const PlanReader& in) {
  const auto z = in.numbers("z", 2);
  return {z[0], z[1]};
}

std::vector<Eigen::Vector2d> pointList(const PlanReader& in, const char* key) {
  std::vector<Eigen::Vector2d> points;
  for (const auto& p : in.array(key)) {
    if (!p.is_array() || p.size() != 2 || !p[0].is_number() || !p[1].is_number())
      in.fail(key, "must be a list of points [x, y]");
    points.emplace_back(p[0].get<double>(), p[1].get<double>());
  }
  return points;
}

void readWalls(const PlanReader& in, Scene& scene) {
  in.forEach("walls", [&](const PlanReader& wall) {
    wall.refuseMisspelt({"a", "b", "thickness", "z", "glass"});
    const auto [low, high] = zRange(wall);
    scene.walls.push_back(
        {wall.xy("a"), wall.xy("b"), wall.number("thickness"), low, high, wall.flag("glass", false)});
  });
  in.forEach("doorways", [&](const PlanReader& doorway) {
    doorway.refuseMisspelt({"floor", "xyz", "width", "height"});
    scene.doorways.push_back({readFloor(doorway, scene), doorway.xyz("xyz"), doorway.number("width"),
                              doorway.number("height", Doorway().height_m, 0, kFar_m)});
  });
  in.forEach("windows", [&](const PlanReader& window) {
    window.refuseMisspelt({"xyz", "width", "height", "glazed"});
    scene.windows.push_back(
        {window.xyz("xyz"), window.number("width"), window.number("height"), window.flag("glazed", false)});
  });
  in.forEach("rooms", [&](const PlanReader& room) {
    room.refuseMisspelt({"id", "floor", "polygon"});
    scene.rooms.push_back({room.text("id", ""), readFloor(room, scene), pointList(room, "polygon")});
  });
}

void readSolids(const PlanReader& in, Scene& scene) {
  in.forEach("boxes", [&](const PlanReader& box) {
    box.allowOnly({"name", "center", "size", "z", "yaw_deg"});
    const auto [low, high] = zRange(box);
    scene.boxes.push_back({box.text("name", ""), box.xy("center"), box.xy("size"), low, high,
                           box.number("yaw_deg", 0, -360, 360) * kDegree_rad});
  });
  in.forEach("columns", [&](const PlanReader& column) {
    column.allowOnly({"name", "center", "radius", "z"});
    const auto [low, high] = zRange(column);
    scene.columns.push_back(
        {column.text("name", ""), column.xy("center"), column.number("radius"), low, high});
  });
  in.forEach("stairs", [&](const PlanReader& stairs) {
    stairs.allowOnly({"foot", "top", "width", "z", "steps"});
    const auto [low, high] = zRange(stairs);
    scene.stairs.push_back({stairs.xy("foot"), stairs.xy("top"), stairs.number("width"), low, high,
                            stairs.integer("steps", Stairs().steps)});
  });
  in.forEach("slabs", [&](const PlanReader& slab) {
    slab.allowOnly({"min", "max", "z"});
    const auto [low, high] = zRange(slab);
    scene.slabs.push_back({slab.xy("min"), slab.xy("max"), low, high});
  });
}

void readLifts(const PlanReader& in, Scene& scene) {
  in.forEach("lifts", [&](const PlanReader& in_lift) {
    in_lift.allowOnly({"name", "floors", "door", "door_height"});
    Lift lift;
    lift.name = in_lift.text("name", "");
    for (const double number : in_lift.numbers("floors", 0)) {
      if (number < 0 || number >= static_cast<double>(scene.floors_z_m.size()) ||
          number != std::floor(number))
        in_lift.fail("floors", "must list indices of the plan's floors");
      lift.floors.push_back(static_cast<int>(number));
    }
    const auto door = pointList(in_lift, "door");
    if (door.size() != 2) in_lift.fail("door", "must be the door's two ends: [[x, y], [x, y]]");
    lift.door_a = door[0];
    lift.door_b = door[1];
    lift.door_height_m = in_lift.number("door_height", lift.door_height_m, 0.5, 10);
    scene.lifts.push_back(lift);
  });
}

void readPeople(const PlanReader& in, Scene& scene) {
  in.forEach("people", [&](const PlanReader& in_person) {
    in_person.allowOnly({"floor", "waypoints", "speed_mps", "start_s"});
    Person person;
    person.floor = readFloor(in_person, scene);
    person.waypoints = pointList(in_person, "waypoints");
    person.speed_mps = in_person.number("speed_mps", person.speed_mps, 0, 5);
    person.start_s = in_person.number("start_s", person.start_s, 0, 1e6);
    scene.people.push_back(person);
  });
}

void readMeshes(const PlanReader& in, Scene& scene) {
  in.forEach("meshes", [&](const PlanReader& in_mesh) {
    in_mesh.allowOnly({"path", "scale", "T_building_mesh"});
    MeshFile mesh;
    mesh.path = in_mesh.text("path", "");
    if (mesh.path.empty()) in_mesh.fail("path", "is missing: name a file, relative to the plan");
    mesh.scale = in_mesh.number("scale", mesh.scale, 1e-6, 1e6);
    if (in_mesh.has("T_building_mesh")) mesh.T_building_mesh = in_mesh.object("T_building_mesh").transform();
    scene.meshes.push_back(mesh);
  });
}

}  // namespace

int readFloor(const PlanReader& in, const Scene& scene) {
  const int floor = in.integer("floor", 0);
  if (floor < 0 || floor >= static_cast<int>(scene.floors_z_m.size()))
    in.fail("floor",
            "is " + std::to_string(floor) + ": floors lists " + std::to_string(scene.floors_z_m.size()));
  return floor;
}

void readBuilding(const PlanReader& in, Scene& scene) {
  if (in.has("floors")) scene.floors_z_m = in.numbers("floors", 0);
  if (scene.floors_z_m.empty()) in.fail("floors", "must list the height of at least one floor");
  readWalls(in, scene);
  readSolids(in, scene);
  readLifts(in, scene);
  readPeople(in, scene);
  readMeshes(in, scene);
}

}  // namespace sgraphs::simulate
