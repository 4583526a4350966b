#include "perception/loops/loop_verification.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

namespace sgraphs {
namespace {

constexpr double kMerge_m = 0.08;
constexpr size_t kMaxMapPatches = 6000;
constexpr size_t kMaxSurroundings = 14;  // old places registered against, the nearest
constexpr size_t kMaxPatches = 1200;     // of the newer look
constexpr size_t kWidePatches = 400;     // of these for the first, wide registration
// The guess comes from a grid of a quarter metre.
constexpr double kWideGate_m = 0.60;
constexpr int kWideIterations = 20;
// Almost nothing: it keeps directions that the surfaces do not see from running away.
constexpr double kFree_m = 0.5;
constexpr double kFree_rad = 0.2;
constexpr double kDistinct_rad = 0.175;
constexpr size_t kSightPartners = 3;  // old keyframes that each newer one is compared with
constexpr double kSightReach_m = 4.0;
constexpr int kLeastSeen = 60;    // patches, before a conflict refutes anything
constexpr double kRefuted = 1.7;  // times the conflict that a loop may have

// All patches in the places' common frame, evenly thinned to `max`.
std::vector<Surfel> unpackedInto(std::span<const PlacedPlace> places, size_t max) {
  size_t total = 0, i = 0;
  for (const PlacedPlace& p : places) total += p.place->patches.size();
  std::vector<Surfel> out;
  for (const PlacedPlace& p : places) {
    const Eigen::Matrix3d R = p.T_frame_body.matrix3();
    for (const PackedPatch& patch : p.place->patches) {
      const size_t before = i * max / std::max(total, max);
      if (++i * max / std::max(total, max) == before) continue;
      Surfel s = patch.unpack();
      s.mean = p.T_frame_body * s.mean;
      s.normal = R * s.normal;
      s.covariance = R * s.covariance * R.transpose();
      out.push_back(s);
    }
  }
  return out;
}

// Old places nearest to a pose, at most kSightPartners.
std::vector<const PlacedPlace*> partnersOf(const Eigen::Vector3d& position, const OldSurroundings& old) {
  std::vector<std::pair<double, const PlacedPlace*>> near;
  for (const PlacedPlace& p : old.places()) {
    const double d = (p.T_frame_body.translation - position).norm();
    if (d < kSightReach_m) near.emplace_back(d, &p);
  }
  std::stable_sort(near.begin(), near.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<const PlacedPlace*> out;
  for (size_t i = 0; i < std::min(near.size(), kSightPartners); ++i) out.push_back(near[i].second);
  return out;
}

double worstSigma(const Matrix6d& covariance, Eigen::Index offset) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(covariance.block<3, 3>(offset, offset));
  return std::sqrt(std::max(0.0, eigen.eigenvalues()[2]));
}

}  // namespace

bool areDistinct(const SE3& a, const SE3& b) {
  const SE3 d = a.inverse() * b;
  return d.translation.norm() > kDistinct_m || so3Log(d.rotation).norm() > kDistinct_rad;
}

OldSurroundings OldSurroundings::ofNearest(std::vector<PlacedPlace> places_anchor) {
  std::stable_sort(places_anchor.begin(), places_anchor.end(),
                   [](const PlacedPlace& a, const PlacedPlace& b) {
                     return a.T_frame_body.translation.norm() < b.T_frame_body.translation.norm();
                   });
  if (places_anchor.size() > kMaxSurroundings) places_anchor.resize(kMaxSurroundings);
  return OldSurroundings(std::move(places_anchor));
}

OldSurroundings::OldSurroundings(std::vector<PlacedPlace> places_anchor)
    : places_(std::move(places_anchor)), map_(RegistrationConfig().cell_m) {
  for (const Surfel& s : unpackedInto(places_, kMaxMapPatches)) map_.insert(s, SE3(), kMerge_m);
}

bool LoopCheck::alike(const LoopVerificationConfig& config) const {
  return overlap >= config.min_overlap && inlier_share >= config.min_inlier_share &&
         conflict_share <= config.max_conflict_share && fit_share >= config.min_fit_share * overlap;
}

bool LoopCheck::fixed(const LoopVerificationConfig& config) const {
  return sigma_m <= config.max_sigma_m && sigma_rad <= config.max_sigma_rad;
}

bool LoopCheck::refuted(const LoopVerificationConfig& config) const {
  return seen >= kLeastSeen && conflict_share >= kRefuted * config.max_conflict_share;
}

LoopCheck checkLoop(const std::vector<PlacedPlace>& query, const OldSurroundings& old, const SE3& guess,
                    const LoopVerificationConfig& config) {
  const std::vector<Surfel> few = unpackedInto(query, kWidePatches);
  const std::vector<Surfel> patches = unpackedInto(query, kMaxPatches);
  Vector6d free;
  free << Eigen::Vector3d::Constant(kFree_m * kFree_m), Eigen::Vector3d::Constant(kFree_rad * kFree_rad);
  const Matrix6d prior = free.cwiseInverse().asDiagonal();
  LoopCheck check;
  check.T_anchor_body = guess;
  RegistrationConfig registration;
  registration.gate_m = kWideGate_m;
  registration.max_iterations = kWideIterations;
  registerRigid(few, old.map(), prior, registration, 1, check.T_anchor_body);
  const RegistrationResult result =
      registerRigid(patches, old.map(), prior, RegistrationConfig(), 1, check.T_anchor_body);
  if (!check.T_anchor_body.isFinite()) return {};
  check.fit_share = result.inlier_share;
  check.covariance = config.covariance_scale * result.covariance;
  check.covariance.diagonal().head<3>().array() += config.floor_m * config.floor_m;
  check.covariance.diagonal().tail<3>().array() += config.floor_rad * config.floor_rad;
  check.sigma_m = worstSigma(check.covariance, 0);
  check.sigma_rad = worstSigma(check.covariance, 3);

  SightCounts newest, all;
  for (size_t i = 0; i < query.size(); ++i) {
    const SE3 T_anchor_query = check.T_anchor_body * query[i].T_frame_body;
    for (const PlacedPlace* p : partnersOf(T_anchor_query.translation, old)) {
      const SE3 T_old_query = p->T_frame_body.inverse() * T_anchor_query;
      const SightCounts forth = p->place->sight.compare(query[i].place->patches, T_old_query);
      const SightCounts back = query[i].place->sight.compare(p->place->patches, T_old_query.inverse());
      if (i == 0) newest.add(forth);
      all.add(forth);
      all.add(back);
    }
  }
  check.overlap = newest.overlap();
  check.inlier_share = all.agreement();
  check.conflict_share = all.conflict();
  check.seen = all.seen;
  return check;
}

}  // namespace sgraphs
