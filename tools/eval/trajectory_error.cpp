#include "tools/eval/trajectory_error.h"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <functional>

#include "common/base/error.h"

namespace sgraphs {
namespace {

constexpr Duration kEvoMaxDifference{10'000};
constexpr double kMaxOvershoot = 0.25;

struct Pairs {
  std::vector<Time> times;
  std::vector<Eigen::Vector3d> truth;
  std::vector<Eigen::Vector3d> estimate;
};

AbsoluteError alignedError(const Pairs& pairs) {
  AbsoluteError result;
  result.T_truth_map = alignPoints(pairs.estimate, pairs.truth);
  std::vector<double> errors;
  for (size_t i = 0; i < pairs.times.size(); ++i) {
    errors.push_back((result.T_truth_map * pairs.estimate[i] - pairs.truth[i]).norm());
    result.over_time.emplace_back(pairs.times[i], errors.back());
  }
  result.translation_m = statisticsOf(std::move(errors));
  return result;
}

const StampedPose& nearest(const std::vector<StampedPose>& trajectory, Time time) {
  const auto next = std::lower_bound(trajectory.begin(), trajectory.end(), time,
                                     [](const StampedPose& p, Time t) { return p.time < t; });
  if (next == trajectory.begin()) return *next;
  if (next == trajectory.end()) return trajectory.back();
  return time - (next - 1)->time <= next->time - time ? *(next - 1) : *next;
}

// Poses of the estimate inside the truth's time, with the truth there and its path length so far.
struct Matched {
  Time time;
  SE3 T_map_body;
  SE3 T_truth_body;
  double path_m = 0;
};

std::vector<Matched> match(const std::vector<StampedPose>& truth, const std::vector<StampedPose>& estimate) {
  std::vector<Matched> matched;
  double path_m = 0;
  size_t row = 1;
  for (const auto& [time, pose] : estimate) {
    const auto T_truth_body = poseAt(truth, time);
    if (!T_truth_body) continue;
    for (; row < truth.size() && truth[row].time <= time; ++row)
      path_m += (truth[row].pose.translation - truth[row - 1].pose.translation).norm();
    const double rest_m = (T_truth_body->translation - truth[row - 1].pose.translation).norm();
    matched.push_back({time, pose, *T_truth_body, path_m + rest_m});
  }
  return matched;
}

// `progress` rises along the trajectory.
std::optional<RelativeError> relativeError(const std::vector<Matched>& poses, double delta,
                                           const std::function<double(const Matched&)>& progress) {
  std::vector<double> translation, rotation;
  size_t j = 0;
  for (size_t i = 0; i < poses.size(); ++i) {
    while (j < poses.size() && progress(poses[j]) < progress(poses[i]) + delta) ++j;
    if (j == poses.size()) break;
    if (progress(poses[j]) - progress(poses[i]) > (1 + kMaxOvershoot) * delta) continue;
    const SE3 truth = poses[i].T_truth_body.inverse() * poses[j].T_truth_body;
    const SE3 estimate = poses[i].T_map_body.inverse() * poses[j].T_map_body;
    const SE3 error = truth.inverse() * estimate;
    translation.push_back(error.translation.norm());
    rotation.push_back(so3Log(error.rotation).norm());
  }
  if (translation.empty()) return std::nullopt;
  return RelativeError{statisticsOf(std::move(translation)), statisticsOf(std::move(rotation))};
}

}  // namespace

std::optional<SE3> poseAt(const std::vector<StampedPose>& trajectory, Time time) {
  const auto next = std::lower_bound(trajectory.begin(), trajectory.end(), time,
                                     [](const StampedPose& p, Time t) { return p.time < t; });
  if (next == trajectory.end()) return std::nullopt;
  if (next->time == time) return next->pose;
  if (next == trajectory.begin()) return std::nullopt;
  const auto& last = *(next - 1);
  const double s = (time - last.time).seconds() / (next->time - last.time).seconds();
  // Positions go along the chord, as the definition of the ATE has it; only the rotation along a geodesic.
  return SE3(last.pose.rotation.slerp(s, next->pose.rotation),
             last.pose.translation + s * (next->pose.translation - last.pose.translation));
}

SE3 alignPoints(const std::vector<Eigen::Vector3d>& from, const std::vector<Eigen::Vector3d>& to) {
  if (from.size() != to.size() || from.size() < 3)
    throw Error("cannot align trajectories: fewer than three poses of the estimate lie in the truth's time");
  const double n = static_cast<double>(from.size());
  Eigen::Vector3d mean_from = Eigen::Vector3d::Zero(), mean_to = Eigen::Vector3d::Zero();
  for (size_t i = 0; i < from.size(); ++i) mean_from += from[i] / n, mean_to += to[i] / n;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (size_t i = 0; i < from.size(); ++i)
    covariance += (to[i] - mean_to) * (from[i] - mean_from).transpose() / n;
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  // Points on a line leave the rotation about it open.
  if (!(svd.singularValues()[1] > 1e-9 * svd.singularValues()[0]))
    throw Error("cannot align trajectories: the path is a straight line or a point");
  Eigen::Vector3d signs(1, 1, 1);
  if (svd.matrixU().determinant() * svd.matrixV().determinant() < 0) signs.z() = -1;
  const Eigen::Matrix3d rotation = svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
  return {Eigen::Quaterniond(rotation).normalized(), mean_to - rotation * mean_from};
}

ErrorStatistics statisticsOf(std::vector<double> errors) {
  ErrorStatistics result;
  result.count = errors.size();
  if (errors.empty()) return result;
  double squares = 0;
  for (const double e : errors) squares += e * e;
  result.rmse = std::sqrt(squares / static_cast<double>(errors.size()));
  std::sort(errors.begin(), errors.end());
  result.max = errors.back();
  const size_t half = errors.size() / 2;
  result.median = errors.size() % 2 ? errors[half] : 0.5 * (errors[half - 1] + errors[half]);
  return result;
}

AbsoluteError absoluteError(const std::vector<StampedPose>& truth, const std::vector<StampedPose>& estimate) {
  Pairs pairs;
  for (const auto& [time, pose] : estimate) {
    const auto T_truth_body = poseAt(truth, time);
    if (!T_truth_body) continue;
    pairs.times.push_back(time);
    pairs.truth.push_back(T_truth_body->translation);
    pairs.estimate.push_back(pose.translation);
  }
  return alignedError(pairs);
}

std::optional<ErrorStatistics> absoluteErrorNearestStamp(const std::vector<StampedPose>& truth,
                                                         const std::vector<StampedPose>& estimate) {
  const bool estimate_is_longer = estimate.size() > truth.size();
  Pairs pairs;
  for (const StampedPose& pose : estimate_is_longer ? truth : estimate) {
    const StampedPose& other = nearest(estimate_is_longer ? estimate : truth, pose.time);
    const Duration difference = std::max(pose.time - other.time, other.time - pose.time);
    if (difference > kEvoMaxDifference) continue;
    pairs.times.push_back(pose.time);
    pairs.truth.push_back((estimate_is_longer ? pose : other).pose.translation);
    pairs.estimate.push_back((estimate_is_longer ? other : pose).pose.translation);
  }
  try {
    return alignedError(pairs).translation_m;
  } catch (const Error&) {
    return std::nullopt;
  }
}

std::optional<RelativeError> relativeErrorPerPath(const std::vector<StampedPose>& truth,
                                                  const std::vector<StampedPose>& estimate, double path_m) {
  return relativeError(match(truth, estimate), path_m, [](const Matched& m) { return m.path_m; });
}

std::optional<RelativeError> relativeErrorPerTime(const std::vector<StampedPose>& truth,
                                                  const std::vector<StampedPose>& estimate,
                                                  Duration duration) {
  return relativeError(match(truth, estimate), duration.seconds(),
                       [&](const Matched& m) { return (m.time - truth.front().time).seconds(); });
}

double timeCoverage(const std::vector<StampedPose>& truth, const std::vector<StampedPose>& estimate,
                    Duration max_gap) {
  if (truth.empty() || truth.back().time <= truth.front().time) return 0;
  int64_t covered_us = 0;
  for (size_t i = 1; i < estimate.size(); ++i) {
    if (estimate[i].time - estimate[i - 1].time > max_gap) continue;
    const Time from = std::max(estimate[i - 1].time, truth.front().time);
    const Time to = std::min(estimate[i].time, truth.back().time);
    covered_us += std::max<int64_t>(0, (to - from).us);
  }
  return static_cast<double>(covered_us) / static_cast<double>((truth.back().time - truth.front().time).us);
}

}  // namespace sgraphs
