#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "backend/graph/situational_graph.h"

namespace sgraphs {

// A mapped plane, or one seen once and not yet mapped, as a new keyframe's observations are compared with.
struct PlaneCandidate {
  const PlaneNode* plane = nullptr;
  // Of (tilt, tilt, offset at the anchor), relative to the keyframe that saw it last.
  Eigen::Matrix3d covariance;
  // Of the new keyframe's pose (tangent of body), relative to the same keyframe.
  Matrix6d pose_covariance;
};

struct AssociationGate {
  // A real wall is no mathematical plane: plaster, skirting boards, posters.
  double surface_m = 0.01;
  double surface_rad = 0.008;
  double chi2 = 16.3;           // 99.9 % of chi-square with 3 degrees of freedom
  double ambiguity = 9.0;       // the runner-up must be worse by this (99.7 % with one degree of freedom)
  double max_angle_rad = 0.26;  // 15 degrees, whatever the covariances say
  double max_gap_m = 1.2;       // a door is no end of a wall
};

// For each observation the index of the candidate it is a new sight of, if any. Sides matter: normals must
// agree. One to one, except that pieces of one face which do not overlap may share a plane. Where two
// distinct planes explain an observation about as well, none is taken.
std::vector<std::optional<size_t>> associatePlanes(const std::vector<PlaneObservation>& observations,
                                                   const SE3& T_map_body,
                                                   const std::vector<PlaneCandidate>& candidates,
                                                   const AssociationGate& gate);

// Squared Mahalanobis distance of the observation from the plane; nothing if it is beyond the gate in angle,
// chi-square or extent.
std::optional<double> planeDistance(const PlaneObservation& z, const SE3& T_map_body,
                                    const PlaneCandidate& candidate, const AssociationGate& gate);

}  // namespace sgraphs
