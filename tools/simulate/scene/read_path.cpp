#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "common/base/error.h"
#include "common/geometry/degree.h"
#include "tools/simulate/scene/read_scene.h"

namespace sgraphs::simulate {
namespace {

using nlohmann::json;

// The ride that begins at the waypoint, which stands on a floor where the lift stops.
void readRide(const PlanReader& in, const Scene& scene, double z_m, Waypoint& waypoint) {
  const std::string name = in.text("lift", "");
  for (size_t i = 0; i < scene.lifts.size(); ++i) {
    const Lift& lift = scene.lifts[i];
    if (lift.name != name) continue;
    const auto stopsAt = [&](double height_m) {
      return std::any_of(lift.floors.begin(), lift.floors.end(), [&](int floor) {
        return std::abs(scene.floors_z_m[static_cast<size_t>(floor)] - height_m) < 1e-6;
      });
    };
    const int to = in.integer("to_floor", -1);
    if (std::find(lift.floors.begin(), lift.floors.end(), to) == lift.floors.end())
      in.fail("to_floor", "is " + std::to_string(to) + ": lift '" + name + "' does not stop there");
    if (!stopsAt(z_m)) in.fail("lift", "'" + name + "' does not stop at z = " + std::to_string(z_m));
    waypoint.lift = static_cast<int>(i);
    waypoint.ride_m = scene.floors_z_m[static_cast<size_t>(to)] - z_m;
    return;
  }
  in.fail("lift", "'" + name + "' is not one of the plan's lifts");
}

std::vector<Waypoint> readWaypoints(const PlanReader& in, const Scene& scene) {
  const double floor_z_m = scene.floors_z_m[static_cast<size_t>(scene.path_floor)];
  std::vector<Waypoint> waypoints;
  double rise_m = 0, ridden_m = 0;  // hold until the next z, the next ride
  const json& list = in.array("waypoints");
  for (size_t i = 0; i < list.size(); ++i) {
    const std::string item = "waypoints[" + std::to_string(i) + "]";
    const json& p = list[i];
    if (p.is_array() && p.size() == 2 && p[0].is_number() && p[1].is_number()) {
      waypoints.push_back({{p[0].get<double>(), p[1].get<double>()}, 0, rise_m, ridden_m});
    } else if (p.is_object()) {
      const PlanReader waypoint(p, "", "");
      try {
        waypoint.allowOnly({"xy", "pause_s", "z", "lift", "to_floor"});
        if (waypoint.has("z")) rise_m = waypoint.number("z") - floor_z_m - ridden_m;
        waypoints.push_back({waypoint.xy("xy"), waypoint.number("pause_s", 0, 0, 3600), rise_m, ridden_m});
        if (waypoint.has("lift")) readRide(waypoint, scene, floor_z_m + rise_m + ridden_m, waypoints.back());
        ridden_m += waypoints.back().ride_m;
      } catch (const Error& error) {
        in.fail(item, std::string("is wrong") + error.what());
      }
    } else {
      in.fail(item, "must be [x, y] or {\"xy\": [x, y], \"pause_s\": 2, \"z\": 0}");
    }
  }
  return waypoints;
}

void readGait(const PlanReader& in, Gait& gait) {
  in.allowOnly({"bob_m", "bob_hz", "roll_deg", "roll_hz", "pitch_deg", "pitch_hz"});
  gait.bob_m = in.number("bob_m", gait.bob_m, 0, 0.1);
  gait.bob_hz = in.number("bob_hz", gait.bob_hz, 0, 10);
  gait.roll_rad = in.number("roll_deg", gait.roll_rad / kDegree_rad, 0, 10) * kDegree_rad;
  gait.roll_hz = in.number("roll_hz", gait.roll_hz, 0, 10);
  gait.pitch_rad = in.number("pitch_deg", gait.pitch_rad / kDegree_rad, 0, 10) * kDegree_rad;
  gait.pitch_hz = in.number("pitch_hz", gait.pitch_hz, 0, 10);
}

}  // namespace

void readPath(const PlanReader& in, Scene& scene) {
  in.allowOnly({"floor", "waypoints", "start_heading_deg", "start_pause_s", "end_pause_s", "speed_mps",
                "acceleration_mps2", "yaw_rate_rad_s", "yaw_acceleration_rad_s2", "turn_radius_m",
                "body_height_m", "clearance_m", "gait"});
  WalkPath& path = scene.path;
  scene.path_floor = readFloor(in, scene);
  path.waypoints = readWaypoints(in, scene);
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
  if (in.has("gait")) readGait(in.object("gait"), path.gait);
}

}  // namespace sgraphs::simulate
