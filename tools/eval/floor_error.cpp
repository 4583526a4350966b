#include "tools/eval/floor_error.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "tools/eval/path_in_plan.h"

namespace sgraphs {
namespace {

void matchByHeight(FloorResult& result) {
  std::vector<std::tuple<double, size_t, size_t>> pairs;
  for (size_t s = 0; s < result.storeys.size(); ++s)
    for (size_t e = 0; e < result.estimates.size(); ++e)
      if (result.estimates[e].z_m)
        pairs.emplace_back(std::abs(*result.estimates[e].z_m - result.storeys[s].z_m), s, e);
  std::sort(pairs.begin(), pairs.end());
  std::vector<bool> taken(result.estimates.size(), false);
  for (const auto& [off_m, s, e] : pairs) {
    if (off_m > FloorResult::kMaxHeightError_m || result.storeys[s].estimate || taken[e]) continue;
    taken[e] = true;
    result.storeys[s].estimate = e;
    result.storeys[s].height_error_m = *result.estimates[e].z_m - result.storeys[s].z_m;
  }
  for (size_t e = 0; e < taken.size(); ++e)
    if (result.estimates[e].z_m && !taken[e])
      result.estimates[e].why_false = "no storey within 0.3 m of its height is left for it";
}

void matchWithoutHeight(FloorResult& result) {
  size_t next = 0;
  for (size_t e = 0; e < result.estimates.size(); ++e) {
    if (result.estimates[e].z_m) continue;
    while (next < result.storeys.size() && (!result.asked(next) || result.storeys[next].estimate)) ++next;
    if (next < result.storeys.size())
      result.storeys[next].estimate = e;
    else
      result.estimates[e].why_false = "has no height, and no storey is left for it";
  }
}

}  // namespace

std::optional<double> shareOf(size_t part, size_t whole) {
  if (!whole) return std::nullopt;
  return static_cast<double>(part) / static_cast<double>(whole);
}

size_t FloorResult::numAsked() const {
  size_t count = 0;
  for (size_t s = 0; s < storeys.size(); ++s) count += asked(s);
  return count;
}

size_t FloorResult::numFound() const {
  size_t count = 0;
  for (size_t s = 0; s < storeys.size(); ++s) count += asked(s) && storeys[s].estimate;
  return count;
}

size_t FloorResult::numFalse() const {
  return static_cast<size_t>(std::count_if(estimates.begin(), estimates.end(),
                                           [](const Estimate& e) { return !e.why_false.empty(); }));
}

FloorResult judgeFloors(const Plan& plan, const std::vector<StampedPose>& truth,
                        const std::vector<EstimatedFloor>& floors, const SE3& T_truth_map) {
  FloorResult result;
  const auto walked = secondsOnStoreys(plan, truth);
  for (size_t s = 0; s < plan.floors_z_m.size(); ++s)
    result.storeys.push_back({plan.floors_z_m[s], walked[s], std::nullopt, std::nullopt});
  for (const EstimatedFloor& floor : floors)
    result.estimates.push_back({floor.id, heightOf(floor, T_truth_map), {}});
  matchByHeight(result);
  matchWithoutHeight(result);
  return result;
}

std::optional<double> heightOf(const EstimatedFloor& floor, const SE3& T_truth_map) {
  if (!floor.z_m) return std::nullopt;
  return (T_truth_map * Eigen::Vector3d(floor.center.x(), floor.center.y(), *floor.z_m)).z();
}

size_t storeyOf(const std::string& floor_id, const std::vector<EstimatedFloor>& floors, const Plan& plan,
                const SE3& T_truth_map) {
  const auto floor =
      std::find_if(floors.begin(), floors.end(), [&](const EstimatedFloor& f) { return f.id == floor_id; });
  const auto z_m = floor == floors.end() ? std::nullopt : heightOf(*floor, T_truth_map);
  if (!z_m) return 0;
  const auto nearest =
      std::min_element(plan.floors_z_m.begin(), plan.floors_z_m.end(),
                       [&](double a, double b) { return std::abs(a - *z_m) < std::abs(b - *z_m); });
  return static_cast<size_t>(nearest - plan.floors_z_m.begin());
}

std::vector<StoreyError> errorByStorey(const Plan& plan, const std::vector<StampedPose>& truth,
                                       const AbsoluteError& error) {
  std::vector<std::vector<double>> errors(plan.floors_z_m.size() + 1);  // the last: on no storey
  for (const auto& [time, error_m] : error.over_time)
    if (const auto T_truth_body = poseAt(truth, time))
      errors[storeyAt(plan, T_truth_body->translation.z()).value_or(plan.floors_z_m.size())].push_back(
          error_m);
  std::vector<StoreyError> result;
  for (size_t s = 0; s < errors.size(); ++s)
    if (!errors[s].empty())
      result.push_back(
          {s < plan.floors_z_m.size() ? std::optional(s) : std::nullopt, statisticsOf(std::move(errors[s]))});
  return result;
}

}  // namespace sgraphs
