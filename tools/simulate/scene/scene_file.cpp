#include "tools/simulate/scene/scene_file.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>

#include "common/base/error.h"
#include "tools/simulate/scene/find_fault.h"
#include "tools/simulate/scene/plan_reader.h"

namespace sgraphs::simulate {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using nlohmann::ordered_json;

constexpr double kDegree_rad = std::numbers::pi / 180;
constexpr double kFar_m = 10000;  // no building is larger

std::vector<double> listOf(const Eigen::Ref<const Eigen::VectorXd>& v) {
  return {v.data(), v.data() + v.size()};
}

std::pair<double, double> zRange(const PlanReader& in) {
  const auto z = in.numbers("z", 2);
  return {z[0], z[1]};
}

int floorOf(const PlanReader& in, const Scene& scene) {
  const int floor = in.integer("floor", 0);
  if (floor < 0 || floor >= static_cast<int>(scene.floors_z_m.size()))
    in.fail("floor",
            "is " + std::to_string(floor) + ": floors lists " + std::to_string(scene.floors_z_m.size()));
  return floor;
}

std::vector<Eigen::Vector2d> pointList(const PlanReader& in, const char* key) {
  std::vector<Eigen::Vector2d> points;
  for (const json& p : in.array(key)) {
    if (!p.is_array() || p.size() != 2 || !p[0].is_number() || !p[1].is_number())
      in.fail(key, "must be a list of points [x, y]");
    points.emplace_back(p[0].get<double>(), p[1].get<double>());
  }
  return points;
}

void readBuilding(const PlanReader& in, Scene& scene) {
  if (in.has("floors")) scene.floors_z_m = in.numbers("floors", 0);
  if (scene.floors_z_m.empty()) in.fail("floors", "must list the height of at least one floor");
  in.forEach("walls", [&](const PlanReader& wall) {
    wall.refuseMisspelt({"a", "b", "thickness", "z"});
    const auto [low, high] = zRange(wall);
    scene.walls.push_back({wall.xy("a"), wall.xy("b"), wall.number("thickness"), low, high});
  });
  in.forEach("doorways", [&](const PlanReader& doorway) {
    doorway.refuseMisspelt({"floor", "xyz", "width", "height"});
    scene.doorways.push_back({floorOf(doorway, scene), doorway.xyz("xyz"), doorway.number("width"),
                              doorway.number("height", Doorway().height_m, 0, kFar_m)});
  });
  in.forEach("rooms", [&](const PlanReader& room) {
    room.refuseMisspelt({"id", "floor", "polygon"});
    scene.rooms.push_back({room.text("id", ""), floorOf(room, scene), pointList(room, "polygon")});
  });
  in.forEach("boxes", [&](const PlanReader& box) {
    box.allowOnly({"name", "center", "size", "z", "yaw_deg"});
    const auto [low, high] = zRange(box);
    scene.boxes.push_back({box.text("name", ""), box.xy("center"), box.xy("size"), low, high,
                           box.number("yaw_deg", 0, -360, 360) * kDegree_rad});
  });
  in.forEach("slabs", [&](const PlanReader& slab) {
    slab.allowOnly({"min", "max", "z"});
    const auto [low, high] = zRange(slab);
    scene.slabs.push_back({slab.xy("min"), slab.xy("max"), low, high});
  });
}

void readSensor(const PlanReader& in, SensorModel& sensor) {
  in.allowOnly(
      {"rpm", "start_azimuth_deg", "range_sigma_m", "min_range_m", "max_range_m", "grazing_drop_deg"});
  sensor.rpm = in.number("rpm", sensor.rpm, 300, 1200);
  sensor.start_azimuth_deg = in.number("start_azimuth_deg", sensor.start_azimuth_deg, 0, 360);
  sensor.range_sigma_m = in.number("range_sigma_m", sensor.range_sigma_m, 0, 1);
  sensor.min_range_m = in.number("min_range_m", sensor.min_range_m, 0, 10);
  sensor.max_range_m = in.number("max_range_m", sensor.max_range_m, 1, 130);
  sensor.grazing_drop_deg = in.number("grazing_drop_deg", sensor.grazing_drop_deg, 0, 90);
}

std::vector<Waypoint> readWaypoints(const PlanReader& in) {
  std::vector<Waypoint> waypoints;
  const json& list = in.array("waypoints");
  for (size_t i = 0; i < list.size(); ++i) {
    const std::string item = "waypoints[" + std::to_string(i) + "]";
    const json& p = list[i];
    if (p.is_array() && p.size() == 2 && p[0].is_number() && p[1].is_number()) {
      waypoints.push_back({{p[0].get<double>(), p[1].get<double>()}, 0});
    } else if (p.is_object()) {
      const PlanReader waypoint(p, "", "");
      try {
        waypoint.allowOnly({"xy", "pause_s"});
        waypoints.push_back({waypoint.xy("xy"), waypoint.number("pause_s", 0, 0, 3600)});
      } catch (const Error& error) {
        in.fail(item, std::string("is wrong") + error.what());
      }
    } else {
      in.fail(item, "must be [x, y] or {\"xy\": [x, y], \"pause_s\": 2}");
    }
  }
  return waypoints;
}

void readPath(const PlanReader& in, Scene& scene) {
  in.allowOnly({"floor", "waypoints", "start_heading_deg", "start_pause_s", "end_pause_s", "speed_mps",
                "acceleration_mps2", "yaw_rate_rad_s", "yaw_acceleration_rad_s2", "turn_radius_m",
                "body_height_m", "clearance_m", "gait"});
  WalkPath& path = scene.path;
  scene.path_floor = floorOf(in, scene);
  path.waypoints = readWaypoints(in);
  path.start_heading_rad = in.number("start_heading_deg", 0, -360, 360) * kDegree_rad;
  path.start_pause_s = in.number("start_pause_s", path.start_pause_s, 0, 3600);
  path.end_pause_s = in.number("end_pause_s", path.end_pause_s, 0, 3600);
  path.speed_mps = in.number("speed_mps", path.speed_mps, 0.05, 2);
  path.acceleration_mps2 = in.number("acceleration_mps2", path.acceleration_mps2, 0.05, 3);
  path.yaw_rate_rad_s = in.number("yaw_rate_rad_s", path.yaw_rate_rad_s, 0.05, 3);
  path.yaw_acceleration_rad_s2 = in.number("yaw_acceleration_rad_s2", path.yaw_acceleration_rad_s2, 0.05, 10);
  path.turn_radius_m = in.number("turn_radius_m", path.turn_radius_m, 0.2, 10);
  path.body_height_m = in.number("body_height_m", path.body_height_m, 0, 5);
  path.clearance_m = in.number("clearance_m", path.clearance_m, 0.01, 5);
  if (!in.has("gait")) return;
  const PlanReader gait = in.object("gait");
  gait.allowOnly({"bob_m", "bob_hz", "roll_deg", "roll_hz", "pitch_deg", "pitch_hz"});
  path.gait.bob_m = gait.number("bob_m", path.gait.bob_m, 0, 0.1);
  path.gait.bob_hz = gait.number("bob_hz", path.gait.bob_hz, 0, 10);
  path.gait.roll_rad = gait.number("roll_deg", path.gait.roll_rad / kDegree_rad, 0, 10) * kDegree_rad;
  path.gait.roll_hz = gait.number("roll_hz", path.gait.roll_hz, 0, 10);
  path.gait.pitch_rad = gait.number("pitch_deg", path.gait.pitch_rad / kDegree_rad, 0, 10) * kDegree_rad;
  path.gait.pitch_hz = gait.number("pitch_hz", path.gait.pitch_hz, 0, 10);
}

json parseJson(const std::string& text, const std::string& where) {
  try {
    return json::parse(text);
  } catch (const json::exception& error) {
    // The library's text holds "parse error at line 3, column 5: …" behind its own tag; a number out of
    // range comes without a line.
    std::string what = error.what();
    if (const size_t at = what.find("line "); at != std::string::npos) what = what.substr(at);
    std::replace(what.begin(), what.end(), '\n', ' ');
    throw Error(where + ": not JSON: " + what);
  }
}

}  // namespace

Scene parseScene(const std::string& text, const std::string& where) {
  const json plan = parseJson(text, where);
  const PlanReader in(plan, where, "");
  in.refuseMisspelt({"scene", "seed", "duration_s", "T_body_lidar", "floors", "rooms", "walls", "doorways",
                     "boxes", "slabs", "sensor", "path", "start_utime"});
  Scene scene;
  scene.name = in.text("scene", "");
  if (in.has("start_utime")) scene.start.us = static_cast<int64_t>(in.number("start_utime", 0, 0, 4e15));
  if (in.has("T_body_lidar")) scene.T_body_lidar = in.object("T_body_lidar").transform();
  readBuilding(in, scene);
  if (in.has("sensor")) readSensor(in.object("sensor"), scene.sensor);
  if (!in.has("path"))
    in.fail("path", "is missing: give {\"waypoints\": [[x, y], …]} (config/scenes/README.md)");
  readPath(in.object("path"), scene);
  if (const auto fault = findFault(scene)) throw Error(where + ": " + *fault);
  return scene;
}

Scene loadScene(const std::string& path) {
  std::ifstream in(path);
  std::ostringstream text;
  if (!in || !(text << in.rdbuf())) throw Error("cannot read plan '" + path + "': check the path");
  Scene scene = parseScene(text.str(), path);
  if (scene.name.empty()) scene.name = fs::absolute(path).parent_path().filename().string();
  return scene;
}

void writePlan(const std::string& path, const Scene& scene) {
  ordered_json plan;
  plan["scene"] = scene.name;
  const Eigen::Quaterniond& q = scene.T_body_lidar.rotation;
  plan["T_body_lidar"] = {{"xyz", listOf(scene.T_body_lidar.translation)},
                          {"qxyzw", {q.x(), q.y(), q.z(), q.w()}}};
  plan["floors"] = scene.floors_z_m;
  plan["rooms"] = plan["walls"] = plan["doorways"] = plan["boxes"] = ordered_json::array();
  for (const Room& room : scene.rooms) {
    ordered_json polygon = ordered_json::array();
    for (const auto& corner : room.polygon) polygon.push_back(listOf(corner));
    plan["rooms"].push_back({{"id", room.id}, {"floor", room.floor}, {"polygon", polygon}});
  }
  for (const Wall& wall : scene.walls)
    plan["walls"].push_back({{"a", listOf(wall.a)},
                             {"b", listOf(wall.b)},
                             {"thickness", wall.thickness_m},
                             {"z", {wall.z_min_m, wall.z_max_m}}});
  for (const Doorway& doorway : scene.doorways)
    plan["doorways"].push_back({{"floor", doorway.floor},
                                {"xyz", listOf(doorway.xyz)},
                                {"width", doorway.width_m},
                                {"height", doorway.height_m}});
  for (const Box& box : scene.boxes)
    plan["boxes"].push_back({{"name", box.name},
                             {"center", listOf(box.center)},
                             {"size", listOf(box.size)},
                             {"z", {box.z_min_m, box.z_max_m}},
                             {"yaw_deg", box.yaw_rad / kDegree_rad}});
  std::ofstream out(path);
  out << plan.dump(1) << '\n';
  out.close();
  if (!out) throw Error("cannot write '" + path + "': check the folder and its permissions");
}

}  // namespace sgraphs::simulate
