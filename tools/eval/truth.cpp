#include "tools/eval/truth.h"

#include <filesystem>
#include <nlohmann/json.hpp>

#include "common/base/error.h"
#include "common/io/text_file.h"

namespace sgraphs {
namespace {

constexpr double kAskedAfter_s = 1.0;
// A body within these heights over a floor is on it.
constexpr double kOnFloorLow_m = -0.2;
constexpr double kOnFloorHigh_m = 1.6;
constexpr double kMaxRowGap_s = 0.2;  // longer gaps of the truth count for no room

constexpr double kWallHeight_m = 2.5;  // of a wall whose plan does not say

TrueWall wallOf(const nlohmann::json& json) {
  const auto a = json.at("a").get<std::array<double, 2>>(), b = json.at("b").get<std::array<double, 2>>();
  const auto z = json.value("z", std::array<double, 2>{0, kWallHeight_m});
  return {{a[0], a[1]}, {b[0], b[1]}, json.value("thickness", 0.0), z[0], z[1]};
}

SE3 transformOf(const nlohmann::json& json) {
  const auto t = json.at("xyz").get<std::array<double, 3>>();
  const auto q = json.value("qxyzw", std::array<double, 4>{0, 0, 0, 1});
  return {Eigen::Quaterniond(q[3], q[0], q[1], q[2]).normalized(), {t[0], t[1], t[2]}};
}

Plan readPlan(const std::string& path) {
  try {
    const auto json = nlohmann::json::parse(readFile(path));
    Plan plan;
    plan.floors_z_m = json.value("floors", std::vector<double>{});
    if (json.contains("T_body_lidar")) plan.T_body_lidar = transformOf(json.at("T_body_lidar"));
    for (const auto& wall : json.value("walls", nlohmann::json::array())) plan.walls.push_back(wallOf(wall));
    plan.num_doorways = json.value("doorways", nlohmann::json::array()).size();
    for (const auto& room : json.value("rooms", nlohmann::json::array())) {
      TrueRoom read{room.at("id"), room.value("floor", 0), {}};
      for (const auto& corner : room.at("polygon")) read.polygon.emplace_back(corner.at(0), corner.at(1));
      plan.rooms.push_back(std::move(read));
    }
    return plan;
  } catch (const nlohmann::json::exception& error) {
    throw Error("cannot read plan '" + path + "': " + error.what());
  }
}

// Even-odd rule.
bool contains(const std::vector<Eigen::Vector2d>& polygon, const Eigen::Vector2d& p) {
  bool inside = false;
  for (size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
    const Eigen::Vector2d &a = polygon[i], &b = polygon[j];
    if ((a.y() > p.y()) != (b.y() > p.y()) &&
        p.x() < a.x() + (b.x() - a.x()) * (p.y() - a.y()) / (b.y() - a.y()))
      inside = !inside;
  }
  return inside;
}

double secondsInside(const TrueRoom& room, double floor_z_m, const std::vector<StampedPose>& poses) {
  double seconds = 0;
  for (size_t i = 1; i < poses.size(); ++i) {
    const Eigen::Vector3d& p = poses[i].pose.translation;
    const double dt_s = (poses[i].time - poses[i - 1].time).seconds();
    if (dt_s > kMaxRowGap_s || p.z() < floor_z_m + kOnFloorLow_m || p.z() > floor_z_m + kOnFloorHigh_m)
      continue;
    if (contains(room.polygon, p.head<2>())) seconds += dt_s;
  }
  return seconds;
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

std::vector<TrueRoom> askedRooms(const Plan& plan, const std::vector<StampedPose>& poses) {
  std::vector<TrueRoom> asked;
  for (const TrueRoom& room : plan.rooms) {
    const auto floor = static_cast<size_t>(room.floor);
    const double z_m = floor < plan.floors_z_m.size() ? plan.floors_z_m[floor] : 0;
    if (!room.optional() && secondsInside(room, z_m, poses) >= kAskedAfter_s) asked.push_back(room);
  }
  return asked;
}

}  // namespace sgraphs
