#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "perception/planes/plane_search.h"

namespace sgraphs {

// A plane fitted to points, with what is known of it (PlaneObservation says of what the covariance is).
struct PlaneFit {
  Hypothesis plane;
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();
  double rms_m = 0;
  bool valid = false;
};

// Iterated weighted least squares, robust against what stands before the plane (Tukey's biweight that ends at
// `distance_m`). A centroid's variance along the normal is that of its raw ranges, as the ray meets the
// surface, and of the surface's roughness, averaged over their number.
//
// Covariance: inverse of the normal equations, times the residuals' own variance (so a noisier sensor than
// expected says so), times `scale`; plus what the points of each scan err together (clustered "sandwich"
// estimate, Liang and Zeger 1986); plus the floors.
PlaneFit fitPlane(const std::vector<ViewedPoint>& points, std::span<const int32_t> members,
                  const Hypothesis& start, double distance_m, const PlaneNoiseConfig& noise);

}  // namespace sgraphs
