#include "backend/loops/loop_layer.h"

#include <Eigen/Cholesky>
#include <algorithm>

#include "backend/keyframe_admission.h"

namespace sgraphs {
namespace {

Vector6d residual(const RelativePose& z, const SE3& T_from_to) {
  return se3Log(z.T_from_to.inverse() * T_from_to);
}

SE3 presentPose(const SituationalGraph& graph, const RelativePose& z) {
  return graph.keyframes.at(z.from).T_map_body.inverse() * graph.keyframes.at(z.to).T_map_body;
}

}  // namespace

std::string LoopLayer::faultOf(const LoopClosure& loop) const {
  const RelativePose& z = loop.pose;
  const auto& keyframes = builder_.graph().keyframes;
  if (!loop.id.valid()) return "its id is negative";
  if (loop.id <= newest_) return "its id is not above the newest, " + newest_.str();
  if (z.kind != RelativePoseKind::kLoop) return "is of another kind";
  if (z.from == z.to) return "joins a keyframe to itself";
  for (const KeyframeId id : {z.from, z.to})
    if (!keyframes.contains(id)) return "names " + id.str() + ", which is not in the graph";
  return faultOfMeasurement(z);
}

// Around the loop and back along the odometry, which knows nothing of walls: what is left must be drift.
bool LoopLayer::odometryAllows(const RelativePose& z) const {
  const std::optional<RelativePose> way = chain_.between(z.from, z.to);
  if (!way) return true;
  const Vector6d r = residual(z, way->T_from_to);
  const Matrix6d S = config_.chain_slack * config_.chain_slack * way->covariance + z.covariance;
  return r.dot(S.ldlt().solve(r)) < config_.contradiction_chi2;
}

double LoopLayer::chi2(const RelativePose& z) const {
  const Vector6d r = residual(z, presentPose(builder_.graph(), z));
  return r.dot(z.covariance.ldlt().solve(r));
}

bool LoopLayer::isLarge(const RelativePose& z) const {
  const Vector6d r = residual(z, presentPose(builder_.graph(), z));
  return r.head<3>().norm() > config_.large_m || r.tail<3>().norm() > config_.large_rad;
}

LoopLayer::Change LoopLayer::switchOn(LoopId id) {
  builder_.switchLoop(id, true);
  return isLarge(builder_.graph().loops.at(id).measurement) ? Change::kLarge : Change::kSmall;
}

LoopLayer::Change LoopLayer::apply(const LoopClosures& loops, std::vector<std::string>& refused) {
  Change change = Change::kNone;
  for (const LoopClosure& loop : loops.accepted) {
    const std::string fault = faultOf(loop);
    newest_ = std::max(newest_, loop.id);
    if (!fault.empty()) {
      refused.push_back("loop " + loop.id.str() + " from " + loop.pose.from.str() + " to " +
                        loop.pose.to.str() + ": " + fault);
      continue;
    }
    builder_.addLoop(loop.id, loop.pose);
    if (odometryAllows(loop.pose))
      change = std::max(change, switchOn(loop.id));
    else
      refused.push_back("loop " + loop.id.str() + " from " + loop.pose.from.str() + " to " +
                        loop.pose.to.str() +
                        ": odometry contradicts it; it has no part until the map agrees");
  }
  for (const LoopId id : loops.withdrawn) {
    const auto known = builder_.graph().loops.find(id);
    if (known == builder_.graph().loops.end()) {
      refused.push_back("loop " + id.str() + " is withdrawn, but was not accepted before");
      continue;
    }
    if (known->second.active()) change = Change::kUndone;
    builder_.removeLoop(id);
  }
  return change;
}

LoopLayer::Change LoopLayer::judge() {
  LoopId worst;
  double most = config_.contradiction_chi2;
  std::vector<LoopId> agreeing;
  for (const auto& [id, loop] : builder_.graph().loops) {
    const double value = chi2(loop.measurement);
    if (loop.active() && value > most) {
      worst = id;
      most = value;
    }
    if (!loop.active() && value < config_.agreement_chi2) agreeing.push_back(id);
  }
  if (worst.valid()) {
    builder_.switchLoop(worst, false);
    return Change::kUndone;
  }
  for (const LoopId id : agreeing) builder_.switchLoop(id, true);
  return agreeing.empty() ? Change::kNone : Change::kSmall;
}

}  // namespace sgraphs
