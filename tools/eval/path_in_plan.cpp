#include "tools/eval/path_in_plan.h"

#include <algorithm>
#include <cmath>

#include "common/geometry/convex_polygon.h"

namespace sgraphs {
namespace {

constexpr double kOnFloorLow_m = -0.2;
constexpr double kOnFloorHigh_m = 1.6;
constexpr double kMaxRowGap_s = 0.2;    // longer gaps of the truth count for nothing
constexpr double kInWallSlack_m = 0.1;  // of a threshold's middle from its wall's centre line

bool onStorey(double floor_z_m, double body_z_m) {
  return body_z_m >= floor_z_m + kOnFloorLow_m && body_z_m <= floor_z_m + kOnFloorHigh_m;
}

// Calls `visit(begin, end)` for each pair of the truth's rows without a gap between them.
template <typename Visit>
void forEachStep(const std::vector<StampedPose>& poses, const Visit& visit) {
  for (size_t i = 1; i < poses.size(); ++i)
    if ((poses[i].time - poses[i - 1].time).seconds() <= kMaxRowGap_s) visit(poses[i - 1], poses[i]);
}

RoomVisit visitOf(const TrueRoom& room, double floor_z_m, const std::vector<StampedPose>& poses) {
  RoomVisit visit;
  std::optional<Time> since;  // inside without a break
  Time last{};
  forEachStep(poses, [&](const StampedPose& begin, const StampedPose& end) {
    const Eigen::Vector3d& p = end.pose.translation;
    if (!onStorey(floor_z_m, p.z()) || !contains(room.polygon, p.head<2>())) {
      since.reset();
      return;
    }
    visit.inside_s += (end.time - begin.time).seconds();
    if (!since || begin.time != last) since = begin.time;
    last = end.time;
    if (!visit.entered && (end.time - *since).seconds() >= RoomVisit::kAskedAfter_s) visit.entered = since;
  });
  return visit;
}

bool crosses(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c,
             const Eigen::Vector2d& d) {
  return (cross(b - a, c - a) > 0) != (cross(b - a, d - a) > 0) &&
         (cross(d - c, a - c) > 0) != (cross(d - c, b - c) > 0);
}

bool walkedThrough(const Plan& plan, const TrueDoorway& doorway, const std::vector<StampedPose>& poses) {
  const auto threshold = thresholdOf(plan, doorway);
  bool walked = false;
  forEachStep(poses, [&](const StampedPose& begin, const StampedPose& end) {
    const Eigen::Vector3d &from = begin.pose.translation, &to = end.pose.translation;
    if (walked || !onStorey(plan.floors_z_m[doorway.floor], to.z())) return;
    walked = threshold ? crosses(threshold->first, threshold->second, from.head<2>(), to.head<2>())
                       : (to - doorway.position).head<2>().norm() <= 0.5 * doorway.width_m;
  });
  return walked;
}

}  // namespace

std::vector<RoomVisit> roomVisits(const Plan& plan, const std::vector<StampedPose>& poses) {
  std::vector<RoomVisit> visits;
  for (const TrueRoom& room : plan.rooms) visits.push_back(visitOf(room, plan.floors_z_m[room.floor], poses));
  return visits;
}

std::vector<bool> askedRooms(const Plan& plan, const std::vector<RoomVisit>& visits) {
  std::vector<bool> asked;
  for (size_t i = 0; i < visits.size(); ++i)
    asked.push_back(!plan.rooms[i].optional() && visits[i].inside_s >= RoomVisit::kAskedAfter_s);
  return asked;
}

std::optional<size_t> storeyAt(const Plan& plan, double body_z_m) {
  std::optional<size_t> storey;
  for (size_t i = 0; i < plan.floors_z_m.size(); ++i)
    if (onStorey(plan.floors_z_m[i], body_z_m) && (!storey || plan.floors_z_m[i] > plan.floors_z_m[*storey]))
      storey = i;
  return storey;
}

std::vector<double> secondsOnStoreys(const Plan& plan, const std::vector<StampedPose>& poses) {
  std::vector<double> seconds(plan.floors_z_m.size(), 0);
  forEachStep(poses, [&](const StampedPose& begin, const StampedPose& end) {
    if (const auto storey = storeyAt(plan, end.pose.translation.z()))
      seconds[*storey] += (end.time - begin.time).seconds();
  });
  return seconds;
}

std::optional<std::pair<Eigen::Vector2d, Eigen::Vector2d>> thresholdOf(const Plan& plan,
                                                                       const TrueDoorway& doorway) {
  const Eigen::Vector2d center = doorway.position.head<2>();
  const TrueWall* nearest = nullptr;
  double least_m = INFINITY;
  for (const TrueWall& wall : plan.walls) {
    const double off_m = distanceToSegment(center, wall.a, wall.b);
    const bool at_this_height =
        doorway.position.z() < wall.z_high_m && doorway.position.z() > wall.z_low_m - kInWallSlack_m;
    if (!at_this_height || off_m > 0.5 * wall.thickness_m + kInWallSlack_m || off_m >= least_m) continue;
    nearest = &wall;
    least_m = off_m;
  }
  if (!nearest || nearest->a == nearest->b) return std::nullopt;
  const Eigen::Vector2d half = 0.5 * doorway.width_m * (nearest->b - nearest->a).normalized();
  return std::pair(Eigen::Vector2d(center - half), Eigen::Vector2d(center + half));
}

std::vector<bool> walkedThrough(const Plan& plan, const std::vector<StampedPose>& poses) {
  std::vector<bool> walked;
  for (const TrueDoorway& doorway : plan.doorways) walked.push_back(walkedThrough(plan, doorway, poses));
  return walked;
}

}  // namespace sgraphs
