#include "tools/eval/truth.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "common/base/error.h"
#include "common/geometry/convex_polygon.h"
#include "common/io/text_file.h"

namespace sgraphs {
namespace {

constexpr double kWallHeight_m = 2.5;  // of a wall whose plan does not say
constexpr double kOnCentreLine_m = 0.05;

TrueWall wallOf(const nlohmann::json& json) {
  const auto a = json.at("a").get<std::array<double, 2>>(), b = json.at("b").get<std::array<double, 2>>();
  const auto z = json.value("z", std::array<double, 2>{0, kWallHeight_m});
  return {{a[0], a[1]}, {b[0], b[1]}, json.value("thickness", 0.0), z[0], z[1], json.value("glass", false)};
}

SE3 mountingOf(const nlohmann::json& json) {
  const auto t = json.at("xyz").get<std::array<double, 3>>();
  const auto q = json.value("qxyzw", std::array<double, 4>{0, 0, 0, 1});
  return {Eigen::Quaterniond(q[3], q[0], q[1], q[2]).normalized(), {t[0], t[1], t[2]}};
}

Corners polygonOf(const nlohmann::json& json) {
  Corners polygon;
  for (const auto& corner : json) polygon.emplace_back(corner.at(0), corner.at(1));
  return polygon;
}

TrueRoom roomOf(const nlohmann::json& json, const std::string& path) {
  TrueRoom room{json.at("id"), json.value("floor", size_t{0}), polygonOf(json.at("polygon"))};
  const std::string problem = whyNoOutline(room.polygon);
  if (!problem.empty()) throw Error("cannot read plan '" + path + "': room " + room.id + " " + problem);
  return room;
}

TrueDoorway doorwayOf(const nlohmann::json& json) {
  const auto p = json.at("xyz").get<std::array<double, 3>>();
  return {json.value("floor", size_t{0}), {p[0], p[1], p[2]}, json.at("width")};
}

// The pane of a glazed window lies in the centre plane of the wall on which its sill stands.
std::optional<TrueWall> paneOf(const nlohmann::json& window, const std::vector<TrueWall>& walls) {
  if (!window.value("glazed", false)) return std::nullopt;
  const auto sill = window.at("xyz").get<std::array<double, 3>>();
  const Eigen::Vector2d middle(sill[0], sill[1]);
  const auto wall = std::find_if(walls.begin(), walls.end(), [&](const TrueWall& w) {
    return distanceToSegment(middle, w.a, w.b) < kOnCentreLine_m;
  });
  if (wall == walls.end()) return std::nullopt;
  const Eigen::Vector2d half = 0.5 * window.at("width").get<double>() * (wall->b - wall->a).normalized();
  return TrueWall{middle - half, middle + half, 0, sill[2], sill[2] + window.at("height").get<double>(),
                  true};
}

// A room or doorway without a storey would be judged against another one's.
void checkStoreys(Plan& plan, const std::string& path) {
  if (plan.floors_z_m.empty() && (!plan.rooms.empty() || !plan.doorways.empty())) plan.floors_z_m = {0.0};
  const auto check = [&](size_t floor, const std::string& what) {
    if (floor >= plan.floors_z_m.size())
      throw Error("cannot read plan '" + path + "': " + what + " is on floor " + std::to_string(floor) +
                  " of " + std::to_string(plan.floors_z_m.size()) + " in \"floors\" (the first one is 0)");
  };
  for (const TrueRoom& room : plan.rooms) check(room.floor, "room " + room.id);
  for (size_t i = 0; i < plan.doorways.size(); ++i)
    check(plan.doorways[i].floor, "doorway " + std::to_string(i));
}

Plan readPlan(const std::string& path) {
  try {
    const auto json = nlohmann::json::parse(readFile(path));
    const auto list = [&](const char* key) { return json.value(key, nlohmann::json::array()); };
    Plan plan;
    plan.floors_z_m = json.value("floors", std::vector<double>{});
    if (json.contains("T_body_lidar")) plan.T_body_lidar = mountingOf(json.at("T_body_lidar"));
    for (const auto& wall : list("walls")) plan.walls.push_back(wallOf(wall));
    for (const auto& window : list("windows"))
      if (const auto pane = paneOf(window, plan.walls)) plan.panes.push_back(*pane);
    for (const auto& doorway : list("doorways")) plan.doorways.push_back(doorwayOf(doorway));
    for (const auto& room : list("rooms")) plan.rooms.push_back(roomOf(room, path));
    checkStoreys(plan, path);
    return plan;
  } catch (const nlohmann::json::exception& error) {
    throw Error("cannot read plan '" + path + "': " + error.what());
  }
}

}  // namespace

Truth readTruth(const std::string& folder) {
  const std::string poses = folder + "/gt.tum", plan = folder + "/plan.json", mesh = folder + "/mesh.ply";
  if (!std::filesystem::is_directory(folder))
    throw Error("'" + folder + "' is no folder: --truth needs one that holds gt.tum");
  if (!std::filesystem::exists(poses)) {
    const bool packed = std::filesystem::exists(poses + ".xz");
    throw Error("'" + folder + "' holds no gt.tum: " +
                (packed ? "unpack gt.tum.xz with 'xz -dk'" : "--truth needs the true poses of the body"));
  }
  Truth truth;
  truth.poses = readTum(poses);
  if (std::filesystem::exists(plan)) truth.plan = readPlan(plan);
  if (std::filesystem::exists(mesh)) truth.mesh = readPlyMesh(mesh);
  return truth;
}

}  // namespace sgraphs
