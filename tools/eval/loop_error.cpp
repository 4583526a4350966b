#include "tools/eval/loop_error.h"

#include <algorithm>

#include "tools/eval/trajectory_error.h"

namespace sgraphs {
namespace {

constexpr double kStep_m = 0.25;      // of the path that is looked at
constexpr double kInterrupt_m = 3.0;  // a return that is left for longer ends
constexpr double kNearby_m = 5.0;     // of path from a return to the loop that it is credited with

struct PathPoint {
  Time time;
  double walked_m = 0;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
};

std::vector<PathPoint> sampled(const std::vector<StampedPose>& truth) {
  std::vector<PathPoint> path;
  for (const StampedPose& p : truth) {
    const double step = path.empty() ? 0 : (p.pose.translation - path.back().position).norm();
    if (!path.empty() && step < kStep_m) continue;
    path.push_back({p.time, path.empty() ? 0 : path.back().walked_m + step, p.pose.translation});
  }
  return path;
}

struct Stretch {
  double begin_m;
  double end_m;
};

std::vector<Stretch> revisits(const std::vector<PathPoint>& path) {
  std::vector<Stretch> out;
  for (const PathPoint& p : path) {
    const bool back = std::any_of(path.begin(), path.end(), [&](const PathPoint& q) {
      return p.walked_m - q.walked_m > LoopResult::kLeft_m &&
             (p.position - q.position).norm() < LoopResult::kRevisit_m;
    });
    if (!back) continue;
    if (out.empty() || p.walked_m - out.back().end_m > kInterrupt_m)
      out.push_back({p.walked_m, p.walked_m});
    else
      out.back().end_m = p.walked_m;
  }
  return out;
}

double walkedAt(const std::vector<PathPoint>& path, Time time) {
  const auto it =
      std::lower_bound(path.begin(), path.end(), time, [](const PathPoint& p, Time t) { return p.time < t; });
  return it == path.end() ? path.back().walked_m : it->walked_m;
}

}  // namespace

LoopResult judgeLoops(const std::vector<MeasuredLink>& links, const std::vector<StampedPose>& truth) {
  LoopResult result;
  if (truth.empty()) return result;
  const std::vector<PathPoint> path = sampled(truth);
  std::vector<double> errors_m, at_m;
  for (const MeasuredLink& link : links) {
    if (link.kind != "loop") continue;
    const auto T_from = poseAt(truth, link.from), T_to = poseAt(truth, link.to);
    if (!T_from || !T_to) continue;
    ++result.accepted;
    const SE3 error = link.T_from_to.inverse() * T_from->inverse() * *T_to;
    const double m = error.translation.norm();
    if (m > LoopResult::kFalse_m || so3Log(error.rotation).norm() > LoopResult::kFalse_rad) {
      ++result.wrong;
      continue;
    }
    errors_m.push_back(m);
    at_m.push_back(walkedAt(path, std::max(link.from, link.to)));
  }
  if (!errors_m.empty()) {
    std::sort(errors_m.begin(), errors_m.end());
    result.median_m = errors_m[errors_m.size() / 2];
    result.max_m = errors_m.back();
  }
  for (const Stretch& s : revisits(path)) {
    ++result.revisits;
    result.missed += std::none_of(at_m.begin(), at_m.end(), [&](double at) {
      return at > s.begin_m - kNearby_m && at < s.end_m + kNearby_m;
    });
  }
  return result;
}

}  // namespace sgraphs
