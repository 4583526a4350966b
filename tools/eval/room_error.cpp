#include "tools/eval/room_error.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <tuple>

#include "tools/eval/floor_error.h"

namespace sgraphs {
namespace {

constexpr double kInCorridorsShare = 0.6;  // of a reported room that may be called a piece of corridor

struct Pair {
  double iou;
  size_t room;
  size_t estimate;
};

RoomResult::Estimate inBuilding(const EstimatedRoom& room, const EstimatedGraph& graph, const Plan& plan,
                                const SE3& T_truth_map) {
  RoomResult::Estimate estimate{room.id, {}, storeyOf(room.floor, graph.floors, plan, T_truth_map), {}};
  const auto floor = std::find_if(graph.floors.begin(), graph.floors.end(),
                                  [&](const EstimatedFloor& f) { return f.id == room.floor; });
  const double z_m = floor == graph.floors.end() ? 0 : floor->z_m.value_or(0);
  for (const Eigen::Vector2d& p : room.polygon)
    estimate.polygon.push_back((T_truth_map * Eigen::Vector3d(p.x(), p.y(), z_m)).head<2>());
  const std::string problem = whyNoOutline(estimate.polygon);
  if (!problem.empty()) estimate.why_false = problem;
  return estimate;
}

// All that overlap on one storey, best first.
std::vector<Pair> overlaps(const Plan& plan, const std::vector<RoomResult::Estimate>& estimates) {
  std::vector<Pair> pairs;
  for (size_t i = 0; i < plan.rooms.size(); ++i)
    for (size_t j = 0; j < estimates.size(); ++j) {
      if (!estimates[j].why_false.empty() || estimates[j].storey != plan.rooms[i].floor) continue;
      const double iou = intersectionOverUnion(plan.rooms[i].polygon, estimates[j].polygon);
      if (iou > 0) pairs.push_back({iou, i, j});
    }
  std::sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) {
    return std::tuple(-a.iou, a.room, a.estimate) < std::tuple(-b.iou, b.room, b.estimate);
  });
  return pairs;
}

bool isPieceOfCorridor(const RoomResult::Estimate& estimate, const Plan& plan) {
  std::vector<Corners> corridors;
  for (const TrueRoom& room : plan.rooms)
    if (room.optional() && room.floor == estimate.storey) corridors.push_back(room.polygon);
  return sharedArea(corridors, {estimate.polygon}) >= kInCorridorsShare * areaOf(estimate.polygon);
}

std::string whyUnmatched(size_t estimate, const std::vector<Pair>& pairs, const Plan& plan,
                         const RoomResult& result) {
  const auto best =
      std::find_if(pairs.begin(), pairs.end(), [&](const Pair& p) { return p.estimate == estimate; });
  if (best == pairs.end()) return "overlaps no true room of its floor";
  const std::string& room = plan.rooms[best->room].id;
  if (best->iou >= RoomResult::kMinIou)
    return "is " + room + " once more, after " + result.estimates[*result.truth[best->room].estimate].id;
  char text[64];
  std::snprintf(text, sizeof text, "IoU %.2f at best, with ", best->iou);
  return text + room;
}

void match(const Plan& plan, RoomResult& result) {
  const auto pairs = overlaps(plan, result.estimates);
  std::vector<bool> taken(result.estimates.size(), false);
  for (const auto& [iou, i, j] : pairs) {
    if (iou < RoomResult::kMinIou || result.truth[i].estimate || taken[j]) continue;
    taken[j] = true;
    result.truth[i].estimate = j;
    result.truth[i].iou = iou;
    result.truth[i].area_error_m2 = areaOf(result.estimates[j].polygon) - areaOf(plan.rooms[i].polygon);
    result.num_true += !plan.rooms[i].optional();
  }
  for (size_t j = 0; j < taken.size(); ++j) {
    RoomResult::Estimate& estimate = result.estimates[j];
    if (!taken[j] && estimate.why_false.empty() && !isPieceOfCorridor(estimate, plan))
      estimate.why_false = whyUnmatched(j, pairs, plan, result);
    result.num_false += !estimate.why_false.empty();
  }
}

void timeDetections(const std::vector<EstimatedRoom>& rooms, RoomResult& result) {
  std::vector<double> seconds;
  for (RoomResult::Truth& room : result.truth) {
    const bool long_visit = room.asked && room.visit.inside_s >= RoomResult::kLongVisit_s;
    result.num_long_visits += long_visit;
    if (!room.estimate || !room.visit.entered || !rooms[*room.estimate].accepted) continue;
    // A room seen through its door before anybody enters is found at once.
    room.detection_s = std::max(0.0, (*rooms[*room.estimate].accepted - *room.visit.entered).seconds());
    if (long_visit) seconds.push_back(*room.detection_s);
  }
  if (!seconds.empty()) result.detection_s = statisticsOf(std::move(seconds));
}

void sumUp(RoomResult& result) {
  std::vector<double> area_errors;
  for (const RoomResult::Truth& room : result.truth) {
    result.num_asked += room.asked;
    if (!room.asked || !room.estimate) continue;
    ++result.num_found;
    result.mean_iou += room.iou;
    area_errors.push_back(std::abs(room.area_error_m2));
  }
  if (result.num_found) result.mean_iou /= static_cast<double>(result.num_found);
  if (!area_errors.empty()) result.area_error_m2 = statisticsOf(std::move(area_errors));
}

}  // namespace

RoomResult judgeRooms(const Plan& plan, const std::vector<StampedPose>& truth, const EstimatedGraph& graph,
                      const SE3& T_truth_map) {
  RoomResult result;
  const auto visits = roomVisits(plan, truth);
  const auto asked = askedRooms(plan, visits);
  for (size_t i = 0; i < plan.rooms.size(); ++i)
    result.truth.push_back({plan.rooms[i].id, visits[i], asked[i], std::nullopt, 0, 0, std::nullopt});
  for (const EstimatedRoom& room : graph.rooms)
    result.estimates.push_back(inBuilding(room, graph, plan, T_truth_map));
  match(plan, result);
  timeDetections(graph.rooms, result);
  sumUp(result);
  return result;
}

}  // namespace sgraphs
