#include "perception/rooms/storey_tracker.h"

#include <algorithm>
#include <cmath>

namespace sgraphs {
namespace {

constexpr double kFit_m = 2.0;      // of path that a slope is fitted to
constexpr double kMinFit_m = 0.8;   // less path says nothing of slopes
constexpr double kRise_m = 0.15;    // gait and thresholds move the body less
constexpr double kLevel_m = 0.12;   // heights within a level walk
constexpr double kArrival_m = 1.5;  // level walk that ends a climb
// A ramp is too gentle to tell on a short stretch: what the heights drift by is less than this slope (1:22)
// over a long one. After a ramp more must be walked before it is told from its end.
constexpr double kRampFit_m = 8.0, kRampSlope = 0.045, kRampRise_m = 0.3;
constexpr double kRampArrival_m = 6.0;
// Storeys lie further apart; lower levels are landings and platforms, until the robot walks about on them.
constexpr double kStorey_m = 1.8;
constexpr double kPlatform_m = 5.0;
constexpr double kOneStorey_m = 0.5;  // apart: what was taken for two storeys is one
// Nobody climbs as much from one keyframe to the next; and no slope is fitted across.
constexpr double kCarried_m = 1.0;
constexpr double kCarriedPath_m = 100.0;

}  // namespace

std::vector<KeyframeFloor> StoreyTracker::step(const std::map<KeyframeId, MapKeyframe>& keyframes) {
  changed_.clear();
  for (Step& step : steps_) {
    const auto keyframe = keyframes.find(step.id);
    if (keyframe != keyframes.end()) step.z_m = keyframe->second.T_map_body.translation.z();
  }
  const KeyframeId last = steps_.empty() ? KeyframeId{} : steps_.back().id;
  measureHeights(keyframes);
  uniteStoreys();
  for (auto it = keyframes.upper_bound(last); it != keyframes.end(); ++it) {
    double path_m = 0;
    if (!steps_.empty()) {
      const Eigen::Vector3d& before = keyframes.at(steps_.back().id).T_map_body.translation;
      path_m = steps_.back().path_m + (it->second.T_map_body.translation - before).head<2>().norm();
    }
    steps_.push_back({it->first, path_m, it->second.T_map_body.translation.z()});
    add(it->second);
  }
  if (!changed_.empty()) measureHeights(keyframes);
  std::vector<KeyframeFloor> result;
  for (const auto& [id, floor] : changed_) result.push_back({id, floor});
  return result;
}

void StoreyTracker::add(const MapKeyframe& keyframe) {
  if (!current_.valid()) {
    current_ = FloorId{next_floor_++};
    heights_[current_] = keyframe.T_map_body.translation.z();
  }
  const size_t n = steps_.size();
  if (n > 1 && std::abs(steps_[n - 1].z_m - steps_[n - 2].z_m) > kCarried_m)
    onCarried();
  else if (climbing_)
    onClimb();
  else
    onStorey();
}

void StoreyTracker::onStorey() {
  const Step& now = steps_.back();
  const auto climbs = [&](size_t first, double least_m, double least_slope, double rise_m) {
    return now.path_m - steps_[first].path_m > least_m && std::abs(slope(first)) > least_slope &&
           std::abs(now.z_m - steps_[first].z_m) > rise_m;
  };
  assign(now.id, current_);
  size_t first = firstWithin(kFit_m);
  if (!climbs(first, kMinFit_m, config_.climb_slope, kRise_m)) {
    first = std::max(arrived_, firstWithin(kRampFit_m));
    if (!climbs(first, kRampFit_m / 2, kRampSlope, kRampRise_m)) return;
  }
  const double begin_z = steps_[first].z_m;
  climbing_ = true;
  // On the climb itself the robot walks half of this within a level walk's heights.
  arrival_m_ = std::clamp(2 * kLevel_m / std::abs(slope(first)), kArrival_m, kRampArrival_m);
  climb_begin_ = first;
  while (std::abs(steps_[climb_begin_].z_m - begin_z) < kLevel_m) ++climb_begin_;
  for (size_t i = climb_begin_; i < steps_.size(); ++i) assign(steps_[i].id, {});
}

void StoreyTracker::onCarried() {
  steps_.back().path_m += kCarriedPath_m;
  arrived_ = climb_begin_ = steps_.size() - 1;
  const FloorId floor = nearestTo(steps_.back().z_m);
  climbing_ = std::abs(heights_.at(floor) - steps_.back().z_m) > config_.same_storey_m;
  arrival_m_ = kArrival_m;
  if (!climbing_) current_ = floor;
  assign(steps_.back().id, climbing_ ? FloorId{} : floor);
}

// A lift has brought the robot back, and loops have told so.
void StoreyTracker::uniteStoreys() {
  for (auto newer = heights_.begin(); newer != heights_.end();) {
    const auto older = std::find_if(heights_.begin(), newer, [&](const auto& other) {
      return std::abs(other.second - newer->second) < kOneStorey_m;
    });
    if (older == newer) {
      ++newer;
      continue;
    }
    if (current_ == newer->first) current_ = older->first;
    for (const auto& [keyframe, floor] : floors_)
      if (floor == newer->first) assign(keyframe, older->first);
    newer = heights_.erase(newer);
  }
}

FloorId StoreyTracker::nearestTo(double z_m) const {
  FloorId nearest;
  double gap = 0;
  for (const auto& [floor, z] : heights_)
    if (!nearest.valid() || std::abs(z - z_m) < gap) {
      nearest = floor;
      gap = std::abs(z - z_m);
    }
  return nearest;
}

void StoreyTracker::onClimb() {
  const Step& now = steps_.back();
  assign(now.id, {});
  size_t first = steps_.size() - 1;
  while (first > climb_begin_ && std::abs(steps_[first - 1].z_m - now.z_m) < kLevel_m) --first;
  const double level_m = now.path_m - steps_[first].path_m;
  if (level_m < arrival_m_) return;
  const FloorId nearest = nearestTo(now.z_m);
  const double gap = std::abs(heights_.at(nearest) - now.z_m);
  if (gap <= config_.same_storey_m) {
    arrive(nearest, first);
  } else if (gap >= kStorey_m || level_m >= kPlatform_m) {
    heights_[FloorId{next_floor_}] = now.z_m;
    arrive(FloorId{next_floor_++}, first);
  }
}

// From step `first` on the robot is there. What it took for a climb was none if it never left the storey.
void StoreyTracker::arrive(FloorId floor, size_t first) {
  arrived_ = first;
  const double home = heights_.at(current_);
  const bool left =
      std::any_of(steps_.begin() + static_cast<std::ptrdiff_t>(climb_begin_), steps_.end(),
                  [&](const Step& s) { return std::abs(s.z_m - home) > config_.same_storey_m; });
  if (floor == current_ && !left) first = climb_begin_;
  for (size_t i = first; i < steps_.size(); ++i) assign(steps_[i].id, floor);
  current_ = floor;
  climbing_ = false;
}

// Least squares of height over path.
double StoreyTracker::slope(size_t first) const {
  const double n = static_cast<double>(steps_.size() - first);
  double mean_s = 0, mean_z = 0, ss = 0, sz = 0;
  for (size_t i = first; i < steps_.size(); ++i) {
    mean_s += steps_[i].path_m / n;
    mean_z += steps_[i].z_m / n;
  }
  for (size_t i = first; i < steps_.size(); ++i) {
    ss += (steps_[i].path_m - mean_s) * (steps_[i].path_m - mean_s);
    sz += (steps_[i].path_m - mean_s) * (steps_[i].z_m - mean_z);
  }
  return ss > 0 ? sz / ss : 0;
}

size_t StoreyTracker::firstWithin(double path_m) const {
  size_t first = steps_.size() - 1;
  while (first > 0 && steps_.back().path_m - steps_[first - 1].path_m <= path_m) --first;
  return first;
}

void StoreyTracker::assign(KeyframeId keyframe, FloorId floor) {
  const auto known = floors_.find(keyframe);
  if (known != floors_.end() && known->second == floor) return;
  floors_[keyframe] = floor;
  changed_[keyframe] = floor;
}

void StoreyTracker::measureHeights(const std::map<KeyframeId, MapKeyframe>& keyframes) {
  std::map<FloorId, std::vector<double>> heights;
  for (const auto& [id, floor] : floors_)
    if (floor.valid()) heights[floor].push_back(keyframes.at(id).T_map_body.translation.z());
  for (auto& [floor, z] : heights) {
    const auto middle = z.begin() + static_cast<std::ptrdiff_t>(z.size() / 2);
    std::nth_element(z.begin(), middle, z.end());
    heights_[floor] = *middle;
  }
}

FloorId StoreyTracker::floorOf(KeyframeId keyframe) const {
  const auto floor = floors_.find(keyframe);
  return floor == floors_.end() ? FloorId{} : floor->second;
}

}  // namespace sgraphs
