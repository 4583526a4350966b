#include <fstream>
#include <nlohmann/json.hpp>

#include "common/base/error.h"
#include "common/geometry/degree.h"
#include "tools/simulate/scene/scene_file.h"

namespace sgraphs::simulate {
namespace {

using nlohmann::ordered_json;

std::vector<double> listOf(const Eigen::Ref<const Eigen::VectorXd>& v) {
  return {v.data(), v.data() + v.size()};
}

void writeWalls(const Scene& scene, ordered_json& plan) {
  for (const Room& room : scene.rooms) {
    ordered_json polygon = ordered_json::array();
    for (const auto& corner : room.polygon) polygon.push_back(listOf(corner));
    plan["rooms"].push_back({{"id", room.id}, {"floor", room.floor}, {"polygon", polygon}});
  }
  for (const Wall& wall : scene.walls)
    plan["walls"].push_back({{"a", listOf(wall.a)},
                             {"b", listOf(wall.b)},
                             {"thickness", wall.thickness_m},
                             {"z", {wall.z_min_m, wall.z_max_m}},
                             {"glass", wall.glass}});
  for (const Doorway& doorway : scene.doorways)
    plan["doorways"].push_back({{"floor", doorway.floor},
                                {"xyz", listOf(doorway.xyz)},
                                {"width", doorway.width_m},
                                {"height", doorway.height_m}});
  for (const Window& window : scene.windows)
    plan["windows"].push_back({{"xyz", listOf(window.xyz)},
                               {"width", window.width_m},
                               {"height", window.height_m},
                               {"glazed", window.glazed}});
}

void writeSolids(const Scene& scene, ordered_json& plan) {
  for (const Box& box : scene.boxes)
    plan["boxes"].push_back({{"name", box.name},
                             {"center", listOf(box.center)},
                             {"size", listOf(box.size)},
                             {"z", {box.z_min_m, box.z_max_m}},
                             {"yaw_deg", box.yaw_rad / kDegree_rad}});
  for (const Column& column : scene.columns)
    plan["columns"].push_back({{"name", column.name},
                               {"center", listOf(column.center)},
                               {"radius", column.radius_m},
                               {"z", {column.z_min_m, column.z_max_m}}});
  for (const Stairs& stairs : scene.stairs)
    plan["stairs"].push_back({{"foot", listOf(stairs.foot)},
                              {"top", listOf(stairs.top)},
                              {"width", stairs.width_m},
                              {"z", {stairs.z_min_m, stairs.z_max_m}},
                              {"steps", stairs.steps}});
  for (const Lift& lift : scene.lifts)
    plan["lifts"].push_back({{"name", lift.name},
                             {"floors", lift.floors},
                             {"door", {listOf(lift.door_a), listOf(lift.door_b)}},
                             {"door_height", lift.door_height_m}});
}

}  // namespace

void writePlan(const std::string& path, const Scene& scene) {
  ordered_json plan;
  plan["scene"] = scene.name;
  const Eigen::Quaterniond& q = scene.T_body_lidar.rotation;
  plan["T_body_lidar"] = {{"xyz", listOf(scene.T_body_lidar.translation)},
                          {"qxyzw", {q.x(), q.y(), q.z(), q.w()}}};
  plan["floors"] = scene.floors_z_m;
  for (const char* key : {"rooms", "walls", "doorways", "boxes", "windows", "columns", "stairs"})
    plan[key] = ordered_json::array();
  writeWalls(scene, plan);
  writeSolids(scene, plan);
  std::ofstream out(path);
  out << plan.dump(1) << '\n';
  out.close();
  if (!out) throw Error("cannot write '" + path + "': check the folder and its permissions");
}

}  // namespace sgraphs::simulate
