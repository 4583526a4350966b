#include "tools/eval/doorway_error.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "common/geometry/convex_polygon.h"
#include "tools/eval/floor_error.h"
#include "tools/eval/path_in_plan.h"

namespace sgraphs {
namespace {

constexpr double kBesideRoom_m = 0.35;  // a threshold's middle lies half a wall away from the rooms beside it
constexpr double kBelowFloor_m = 0.3;   // that a doorway's point may lie by error

bool isBeside(const TrueDoorway& doorway, const TrueRoom& room) {
  if (doorway.floor != room.floor) return false;
  const Eigen::Vector2d p = doorway.position.head<2>();
  for (size_t i = 0, j = room.polygon.size() - 1; i < room.polygon.size(); j = i++)
    if (distanceToSegment(p, room.polygon[j], room.polygon[i]) <= kBesideRoom_m) return true;
  return false;
}

bool isOfAskedRoom(const TrueDoorway& doorway, const Plan& plan, const std::vector<bool>& asked) {
  for (size_t i = 0; i < plan.rooms.size(); ++i)
    if (asked[i] && isBeside(doorway, plan.rooms[i])) return true;
  return false;
}

// The highest storey whose floor is not above the point.
size_t storeyBelow(double z_m, const Plan& plan) {
  std::optional<size_t> below;
  for (size_t s = 0; s < plan.floors_z_m.size(); ++s)
    if (plan.floors_z_m[s] <= z_m + kBelowFloor_m && (!below || plan.floors_z_m[s] > plan.floors_z_m[*below]))
      below = s;
  return below.value_or(0);
}

DoorwayResult::Estimate inBuilding(const EstimatedDoorway& doorway, const EstimatedGraph& graph,
                                   const Plan& plan, const SE3& T_truth_map) {
  const Eigen::Vector3d position = T_truth_map * doorway.position;
  const bool floor_has_height =
      std::any_of(graph.floors.begin(), graph.floors.end(),
                  [&](const EstimatedFloor& f) { return f.id == doorway.floor && f.z_m; });
  const size_t storey = floor_has_height ? storeyOf(doorway.floor, graph.floors, plan, T_truth_map)
                                         : storeyBelow(position.z(), plan);
  return {doorway.source, doorway.target, position, doorway.width_m, storey, false};
}

void match(const Plan& plan, DoorwayResult& result) {
  std::vector<std::tuple<double, size_t, size_t>> pairs;
  for (size_t i = 0; i < plan.doorways.size(); ++i)
    for (size_t j = 0; j < result.estimates.size(); ++j) {
      const double off_m = (plan.doorways[i].position - result.estimates[j].position).head<2>().norm();
      if (result.estimates[j].storey == plan.doorways[i].floor && off_m <= DoorwayResult::kMaxDistance_m)
        pairs.emplace_back(off_m, i, j);
    }
  std::sort(pairs.begin(), pairs.end());
  for (const auto& [off_m, i, j] : pairs) {
    if (result.truth[i].estimate || result.estimates[j].is_true) continue;
    result.estimates[j].is_true = true;
    result.truth[i].estimate = j;
    result.truth[i].distance_m = off_m;
    result.truth[i].width_error_m = result.estimates[j].width_m - plan.doorways[i].width_m;
  }
}

void sumUp(DoorwayResult& result) {
  std::vector<double> distances, widths;
  for (const DoorwayResult::Truth& doorway : result.truth) {
    const bool found = doorway.estimate.has_value();
    const auto count = [&](bool asked, DoorwayResult::Count& in) {
      in.asked += asked;
      in.found += asked && found;
    };
    count(doorway.walked_through, result.walked_through);
    count(doorway.of_asked_room, result.of_asked_rooms);
    count(true, result.all);
    if (!found) continue;
    distances.push_back(doorway.distance_m);
    widths.push_back(std::abs(doorway.width_error_m));
  }
  result.num_false = result.estimates.size() - distances.size();
  if (distances.empty()) return;
  result.distance_m = statisticsOf(std::move(distances));
  result.width_error_m = statisticsOf(std::move(widths));
}

}  // namespace

DoorwayResult judgeDoorways(const Plan& plan, const std::vector<StampedPose>& truth,
                            const EstimatedGraph& graph, const SE3& T_truth_map) {
  DoorwayResult result;
  const auto asked = askedRooms(plan, roomVisits(plan, truth));
  const auto walked = walkedThrough(plan, truth);
  for (size_t i = 0; i < plan.doorways.size(); ++i)
    result.truth.push_back({walked[i], isOfAskedRoom(plan.doorways[i], plan, asked), std::nullopt, 0, 0});
  for (const EstimatedDoorway& doorway : graph.doorways)
    result.estimates.push_back(inBuilding(doorway, graph, plan, T_truth_map));
  match(plan, result);
  sumUp(result);
  return result;
}

}  // namespace sgraphs
