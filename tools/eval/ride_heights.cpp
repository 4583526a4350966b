#include "tools/eval/ride_heights.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "tools/eval/trajectory_error.h"

namespace sgraphs {
namespace {

constexpr double kJump_m = 2.0;      // between two poses: no robot climbs so fast
constexpr double kOneLevel_m = 1.5;  // between levels that are one
constexpr double kArrived_m = 0.05;

bool jumps(const StampedPose& before, const StampedPose& after) {
  return std::abs(after.pose.translation.z() - before.pose.translation.z()) > kJump_m;
}

}  // namespace

RideHeights::RideHeights(const std::vector<StampedPose>& estimate, const std::vector<StampedPose>& truth) {
  findLevels(estimate, truth);
  findRides(estimate, truth);
}

void RideHeights::findLevels(const std::vector<StampedPose>& estimate,
                             const std::vector<StampedPose>& truth) {
  std::vector<std::vector<double>> off;
  const auto levelOf = [&](double z_min_m, double z_max_m) {
    for (size_t i = 0; i < levels_.size(); ++i) {
      Level& level = levels_[i];
      if (z_min_m > level.z_max_m + kOneLevel_m || z_max_m < level.z_min_m - kOneLevel_m) continue;
      level.z_min_m = std::min(level.z_min_m, z_min_m);
      level.z_max_m = std::max(level.z_max_m, z_max_m);
      return i;
    }
    levels_.push_back({z_min_m, z_max_m, 0.0});
    off.emplace_back();
    return levels_.size() - 1;
  };
  for (size_t first = 0; first < estimate.size();) {
    size_t last = first;
    while (last + 1 < estimate.size() && !jumps(estimate[last], estimate[last + 1])) ++last;
    double z_min_m = std::numeric_limits<double>::infinity(), z_max_m = -z_min_m;
    for (size_t i = first; i <= last; ++i) {
      z_min_m = std::min(z_min_m, estimate[i].pose.translation.z());
      z_max_m = std::max(z_max_m, estimate[i].pose.translation.z());
    }
    std::vector<double>& values = off[levelOf(z_min_m, z_max_m)];
    for (size_t i = first; i <= last; ++i)
      if (const auto there = poseAt(truth, estimate[i].time))
        values.push_back(there->translation.z() - estimate[i].pose.translation.z());
    first = last + 1;
  }
  // Where the estimate's frame lies is the alignment's matter: the first level stays.
  for (size_t i = 0; i < levels_.size(); ++i)
    if (!off[i].empty() && !off.front().empty())
      levels_[i].shift_m = statisticsOf(off[i]).median - statisticsOf(off.front()).median;
}

double RideHeights::shiftAt(double z_m) const {
  double nearest_m = std::numeric_limits<double>::infinity(), shift_m = 0;
  for (const Level& level : levels_) {
    const double away_m = std::max({0.0, level.z_min_m - z_m, z_m - level.z_max_m});
    if (away_m >= nearest_m) continue;
    nearest_m = away_m;
    shift_m = level.shift_m;
  }
  return shift_m;
}

void RideHeights::findRides(const std::vector<StampedPose>& estimate, const std::vector<StampedPose>& truth) {
  std::vector<StampedPose> poses = estimate;
  correct(poses);
  const auto offAt = [&](const StampedPose& p) -> std::optional<double> {
    const auto there = poseAt(truth, p.time);
    return there ? std::optional(there->translation.z() - p.pose.translation.z()) : std::nullopt;
  };
  const auto first =
      std::find_if(poses.begin(), poses.end(), [&](const auto& p) { return offAt(p).has_value(); });
  if (first == poses.end()) return;
  const double usual_m = *offAt(*first);
  for (size_t i = 1; i < poses.size(); ++i) {
    if (!jumps(estimate[i - 1], estimate[i])) continue;
    size_t k = i;
    for (; k > 0; --k) {
      const auto off_m = offAt(poses[k - 1]);
      if (!off_m || std::abs(*off_m - usual_m) < kArrived_m) break;
    }
    if (k < i) rides_.emplace_back(poses[k].time, poses[i - 1].time);
  }
}

bool RideHeights::riding(Time time) const {
  return std::any_of(rides_.begin(), rides_.end(),
                     [&](const auto& ride) { return time >= ride.first && time <= ride.second; });
}

void RideHeights::correct(std::vector<StampedPose>& poses) const {
  for (StampedPose& p : poses) p.pose.translation.z() += shiftAt(p.pose.translation.z());
}

void RideHeights::correct(EstimatedGraph& graph) const {
  std::erase_if(graph.keyframes, [&](const EstimatedKeyframe& k) { return riding(k.time); });
  for (EstimatedKeyframe& k : graph.keyframes)
    k.T_map_body.translation.z() += shiftAt(k.T_map_body.translation.z());
  for (EstimatedWall& wall : graph.walls) {
    const double shift_m = shiftAt(wall.centroid.z());
    wall.centroid.z() += shift_m;
    for (Eigen::Vector3d& corner : wall.polygon) corner.z() += shift_m;
  }
  for (EstimatedFloor& floor : graph.floors)
    if (floor.z_m) *floor.z_m += shiftAt(*floor.z_m);
  for (EstimatedDoorway& doorway : graph.doorways) doorway.position.z() += shiftAt(doorway.position.z());
}

}  // namespace sgraphs
