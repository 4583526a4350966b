#include "backend/keyframe_admission.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace sgraphs {
namespace {

constexpr double kUnitTolerance = 1e-6;
// Standard deviations between 0.1 um (urad) and 10 km pass, within seven decades of each other: beyond that
// the normal equations lose their digits.
constexpr double kMinVariance = 1e-14;
constexpr double kMaxVariance = 1e8;
constexpr double kMaxVarianceRatio = 1e14;

bool isRigid(const SE3& T) {
  return T.isFinite() && std::abs(T.rotation.norm() - 1.0) < kUnitTolerance;
}

// Why the covariance cannot weigh a measurement; empty if it can.
std::string faultOfCovariance(const Matrix6d& covariance) {
  if (!covariance.allFinite()) return "covariance is not finite";
  if (!covariance.isApprox(covariance.transpose(), 1e-6)) return "covariance is not symmetric";
  const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen(covariance, Eigen::EigenvaluesOnly);
  if (eigen.eigenvalues()(0) < kMinVariance) return "covariance is not positive definite";
  if (eigen.eigenvalues()(5) > std::min(kMaxVariance, kMaxVarianceRatio * eigen.eigenvalues()(0)))
    return "covariance is out of range";
  return {};
}

const char* nameOf(RelativePoseKind kind) {
  if (kind == RelativePoseKind::kOdometry) return "odometry";
  return kind == RelativePoseKind::kNeighbour ? "neighbour" : "loop";
}

std::string faultOfKeyframe(const Keyframe& keyframe, const SituationalGraph& graph) {
  if (!keyframe.id.valid()) return "its id is negative";
  if (!isRigid(keyframe.T_odom_body)) return "T_odom_body is not a finite rigid transform";
  if (graph.keyframes.empty()) return {};
  const KeyframeNode& newest = graph.keyframes.rbegin()->second;
  if (keyframe.id <= newest.id) return "its id is not above the newest, " + newest.id.str();
  if (keyframe.time <= newest.time) return "its time is not after that of " + newest.id.str();
  return {};
}

std::string faultOfRelativePose(const RelativePose& z, const Keyframe& keyframe,
                                const SituationalGraph& graph) {
  const auto known = [&](KeyframeId id) { return id == keyframe.id || graph.keyframes.contains(id); };
  if (z.from == z.to) return "joins a keyframe to itself";
  if (z.from != keyframe.id && z.to != keyframe.id) return "is not about the keyframe it came with";
  if (z.kind != RelativePoseKind::kOdometry && z.kind != RelativePoseKind::kNeighbour &&
      z.kind != RelativePoseKind::kLoop)
    return "is of an unknown kind";
  if (!known(z.from)) return "names " + z.from.str() + ", which is not in the graph";
  if (!known(z.to)) return "names " + z.to.str() + ", which is not in the graph";
  return faultOfMeasurement(z);
}

bool sameMeasurement(const RelativePose& a, const RelativePose& b) {
  return a.kind == b.kind && std::minmax(a.from, a.to) == std::minmax(b.from, b.to);
}

void admitRelativePoses(const Keyframe& keyframe, const SituationalGraph& graph, Admission& admission) {
  for (const RelativePose& z : keyframe.relative_poses) {
    std::string fault = faultOfRelativePose(z, keyframe, graph);
    if (fault.empty()) {
      for (const RelativePose& other : admission.relative_poses)
        if (sameMeasurement(z, other)) fault = "was measured twice";
    }
    if (fault.empty())
      admission.relative_poses.push_back(z);
    else
      admission.refused.push_back(std::string(nameOf(z.kind)) + " " + z.from.str() + " to " + z.to.str() +
                                  " of keyframe " + keyframe.id.str() + ": " + fault);
  }
}

void admitUp(const Keyframe& keyframe, Admission& admission) {
  if (keyframe.up_body.isZero(0.0) && keyframe.up_sigma_rad == 0) return;  // unknown
  admission.has_up = std::abs(keyframe.up_body.norm() - 1.0) < kUnitTolerance &&
                     std::isfinite(keyframe.up_sigma_rad) && keyframe.up_sigma_rad > 1e-9;
  if (!admission.has_up)
    admission.refused.push_back("up of keyframe " + keyframe.id.str() +
                                ": not a unit vector with a positive sigma");
}

}  // namespace

std::string faultOfMeasurement(const RelativePose& z) {
  if (!isRigid(z.T_from_to)) return "T_from_to is not a finite rigid transform";
  return faultOfCovariance(z.covariance);
}

Matrix6d bridgeCovariance(const SE3& T_from_to) {
  const double sigma_m = 0.05 + 0.1 * T_from_to.translation.norm();
  const double sigma_rad = 0.02 + 0.1 * so3Log(T_from_to.rotation).norm();
  Vector6d variances;
  variances << Eigen::Vector3d::Constant(sigma_m * sigma_m), Eigen::Vector3d::Constant(sigma_rad * sigma_rad);
  return variances.asDiagonal();
}

Admission admit(const Keyframe& keyframe, const SituationalGraph& graph) {
  Admission admission;
  if (const std::string fault = faultOfKeyframe(keyframe, graph); !fault.empty()) {
    admission.refused.push_back("keyframe " + keyframe.id.str() + ": " + fault);
    return admission;
  }
  admission.accepted = true;
  admitRelativePoses(keyframe, graph, admission);
  admitUp(keyframe, admission);
  if (graph.keyframes.empty()) return admission;

  for (const RelativePose& z : admission.relative_poses)
    if (z.kind != RelativePoseKind::kLoop) return admission;
  const KeyframeNode& newest = graph.keyframes.rbegin()->second;
  RelativePose bridge;
  bridge.from = newest.id;
  bridge.to = keyframe.id;
  bridge.T_from_to = newest.T_odom_body.inverse() * keyframe.T_odom_body;
  bridge.covariance = bridgeCovariance(bridge.T_from_to);
  admission.relative_poses.push_back(bridge);
  admission.bridged = true;
  return admission;
}

}  // namespace sgraphs
