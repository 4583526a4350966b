#include "backend/output/dense_trajectory.h"

#include <algorithm>
#include <set>

namespace sgraphs {
namespace {

struct Correction {
  Time time;
  SE3 T_map_odom;
  bool after_ride;  // nothing of it belongs to the poses before
};

std::vector<Correction> corrections(const SituationalGraph& graph) {
  std::set<KeyframeId> after_ride;
  for (const RelativePoseFactor& factor : graph.relative_poses)
    if (leavesHeightOpen(factor.measurement)) after_ride.insert(factor.measurement.to);
  std::vector<Correction> result;
  result.reserve(graph.keyframes.size());
  for (const auto& [id, node] : graph.keyframes)
    result.push_back({node.time, node.T_map_body * node.T_odom_body.inverse(), after_ride.contains(id)});
  std::stable_sort(result.begin(), result.end(),
                   [](const auto& a, const auto& b) { return a.time < b.time; });
  return result;
}

SE3 correctionAt(const std::vector<Correction>& all, Time time) {
  if (all.empty()) return {};
  const auto next =
      std::upper_bound(all.begin(), all.end(), time, [](Time t, const Correction& c) { return t < c.time; });
  if (next == all.begin()) return all.front().T_map_odom;
  const auto last = next - 1;
  if (next == all.end() || last->time == time || next->after_ride) return last->T_map_odom;
  const double s = (time - last->time).seconds() / (next->time - last->time).seconds();
  return interpolate(last->T_map_odom, next->T_map_odom, s);
}

}  // namespace

std::vector<StampedPose> denseTrajectory(const SituationalGraph& graph,
                                         std::span<const OdometryEstimate> scans) {
  const auto all = corrections(graph);
  std::vector<StampedPose> result;
  result.reserve(scans.size());
  for (const auto& scan : scans)
    result.push_back({scan.time, correctionAt(all, scan.time) * scan.T_odom_body});
  return result;
}

std::vector<StampedPose> keyframeTrajectory(const SituationalGraph& graph) {
  std::vector<StampedPose> result;
  for (const auto& [id, node] : graph.keyframes) result.push_back({node.time, node.T_map_body});
  std::stable_sort(result.begin(), result.end(),
                   [](const auto& a, const auto& b) { return a.time < b.time; });
  return result;
}

std::vector<StampedPose> odometryTrajectory(std::span<const OdometryEstimate> scans) {
  std::vector<StampedPose> result;
  for (const auto& scan : scans) result.push_back({scan.time, scan.T_odom_body});
  return result;
}

}  // namespace sgraphs
