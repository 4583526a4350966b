#pragma once

#include <optional>
#include <vector>

#include "common/base/time.h"
#include "perception/odometry/odometry_config.h"
#include "perception/odometry/surfel_map.h"

namespace sgraphs {

// Motion of the body over one scan: knots at equal distances in time, constant twist between them.
struct ScanMotion {
  Time begin;
  Time end;
  std::vector<SE3> T_odom_body;  // at least two: begin, ..., end

  // Which two knots surround an instant, and the share of the second; clamped to the ends.
  struct Place {
    size_t knot;
    double share;
  };
  Place placeOf(int32_t time_us) const;
  SE3 at(int32_t time_us) const;
  Duration step() const;
};

// What is expected of the motion before the scan is looked at.
struct MotionPrior {
  Matrix6d begin_information = Matrix6d::Identity();  // on the first knot, about its given value
  // On each piece: Log(Z^-1 * X_j^-1 X_j+1); where `relative` is empty, on the change of twist between
  // pieces.
  std::vector<SE3> relative;
  std::vector<Matrix6d> relative_information;
  Vector6d previous_twist = Vector6d::Zero();  // of the last piece of the previous scan
  bool has_previous_twist = false;
  Matrix6d acceleration_information = Matrix6d::Identity();  // of the change of motion from piece to piece
  // Height of the last knot in odom; no information: not held.
  double height_m = 0;
  double height_information = 0;
};

struct RegistrationResult {
  int matches = 0;
  double inlier_share = 0;
  double residual_rms_m = 0;
  int iterations = 0;
  bool converged = false;
  Matrix6d covariance = Matrix6d::Identity();     // of the last knot, priors included
  Matrix6d lidar_information = Matrix6d::Zero();  // of one rigid pose, without priors
};

// VGICP with the body moving during the scan. A patch with mean p at share a between knots X_j, X_j+1 lies at
// X_j exp(a Log(X_j^-1 X_j+1)) p; against a cell (mu, C) with normal n the Mahalanobis distance of VGICP,
// (mu - T p)^T (C + R C_p R^T)^-1 (mu - T p), keeps only its component along n: along the surface a cell's
// mean says nothing but where the sensor happened to sample, and counting it would freeze motion along a
// corridor. Gauss-Newton over all knots with a Cauchy kernel, which narrows on upright surfaces from
// iteration to iteration (graduated non-convexity: Black and Rangarajan, "On the unification of line
// processes", 1996): a wide one finds the walls from far off, and lets somebody who walks along bend the
// motion within the scan until wall and person agree. The map's z axis is up. Sums are formed in fixed
// blocks, so that the number of threads does not change a bit. `motion` holds the guess and receives the
// result.
RegistrationResult registerScan(const std::vector<Surfel>& surfels, const SurfelMap& map,
                                const MotionPrior& prior, const RegistrationConfig& config, int threads,
                                ScanMotion& motion);

// The same for a rigid cloud of patches (all at one instant): T_target_source from its guess.
// `gate_m` narrows config.gate_m.
RegistrationResult registerRigid(const std::vector<Surfel>& surfels, const SurfelMap& map,
                                 const Matrix6d& prior_information, const RegistrationConfig& config,
                                 int threads, SE3& T_target_source);

}  // namespace sgraphs
