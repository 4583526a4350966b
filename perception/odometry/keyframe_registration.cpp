#include "perception/odometry/keyframe_registration.h"

namespace sgraphs {
namespace {

constexpr size_t kKeptKeyframes = 2;
constexpr double kMinInlierShare = 0.3;
constexpr int kMinCloudMatches = 200;
// What holds directions that the overlap of two keyframes does not see: almost nothing, so that such a
// direction gets almost no weight in the graph.
constexpr double kFree_m = 0.5;
constexpr double kFree_rad = 0.2;
constexpr double kCloudMerge_m = 0.08;

}  // namespace

KeyframeRegistration::KeyframeRegistration(const RegistrationConfig& registration,
                                           const CovarianceConfig& covariance)
    : registration_(registration), covariance_(covariance) {}

std::vector<RelativePose> KeyframeRegistration::step(KeyframeId id, const SE3& T_odom_body,
                                                     const std::vector<Surfel>& surfels,
                                                     const Matrix6d& anchor_covariance, int threads) {
  std::vector<RelativePose> measured;
  Vector6d free;
  free << Eigen::Vector3d::Constant(kFree_m * kFree_m), Eigen::Vector3d::Constant(kFree_rad * kFree_rad);
  const Matrix6d prior = free.cwiseInverse().asDiagonal();
  // The odometry between neighbours brings the guess far inside the gate.
  for (const Reference& reference : references_) {
    SE3 T_from_to = reference.T_odom_body.inverse() * T_odom_body;
    const RegistrationResult result =
        registerRigid(surfels, reference.map, prior, registration_, threads, T_from_to);
    if (result.matches < kMinCloudMatches || result.inlier_share < kMinInlierShare) continue;
    RelativePose r;
    r.kind = RelativePoseKind::kNeighbour;
    r.from = reference.id;
    r.to = id;
    r.T_from_to = T_from_to;
    r.registered = true;
    r.covariance = covariance_.neighbour_scale * result.covariance +
                   composeCovariance(reference.anchor_covariance, T_from_to, anchor_covariance);
    r.covariance.diagonal().head<3>().array() +=
        covariance_.neighbour_floor_m * covariance_.neighbour_floor_m;
    r.covariance.diagonal().tail<3>().array() +=
        covariance_.neighbour_floor_rad * covariance_.neighbour_floor_rad;
    measured.push_back(r);
  }
  Reference reference{id, T_odom_body, anchor_covariance, SurfelMap(registration_.cell_m)};
  for (const Surfel& s : surfels) reference.map.insert(s, SE3(), kCloudMerge_m);
  references_.push_back(std::move(reference));
  if (references_.size() > kKeptKeyframes) references_.pop_front();
  return measured;
}

}  // namespace sgraphs
