#include "backend/planes/plane_association.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "backend/planes/plane_extent.h"
#include "backend/planes/plane_residual.h"

namespace sgraphs {
namespace {

// Two observations of one keyframe are pieces of one face if less than this part of the smaller overlaps.
constexpr double kPieceOverlap = 0.1;
// Doors make gaps in a wall sideways; one as high as a slab parts the walls of two storeys.
constexpr double kMaxGapUp_m = 0.25;

struct Match {
  double distance2;
  size_t observation, candidate;
  auto key() const { return std::tie(distance2, observation, candidate); }
};

bool overlapMuch(const Polygon2d& a, const Polygon2d& b) {
  return overlapArea(a, b) > kPieceOverlap * std::min(polygonArea(a), polygonArea(b));
}

double gapUp(const PlaneObservation& z, const SE3& T_map_body, const PlaneNode& plane) {
  const auto [low, high] = std::minmax_element(plane.polygon_map.begin(), plane.polygon_map.end(),
                                               [](const auto& a, const auto& b) { return a.z() < b.z(); });
  if (low == plane.polygon_map.end() || z.boundary.empty()) return 0.0;
  const TangentBasis axes = tangentBasis(z.normal_body);
  double below = -std::numeric_limits<double>::infinity(), above = below;
  for (const Eigen::Vector2f& corner : z.boundary) {
    const double height = (T_map_body * (z.centroid_body + axes * corner.cast<double>())).z();
    below = std::max(below, height);   // the highest, should it be below
    above = std::max(above, -height);  // the lowest, should it be above
  }
  return std::max({0.0, low->z() - below, -above - high->z()});
}

// Two candidates are rivals if they could not be one surface: pieces of one wall are no ambiguity.
bool distinct(const PlaneNode& a, const PlaneNode& b, const AssociationGate& gate) {
  const double sine = a.normal_map.cross(b.normal_map).norm();
  return sine > 5 * gate.surface_rad || std::abs(a.distance(b.centroid_map)) > 3 * gate.surface_m ||
         a.normal_map.dot(b.normal_map) < 0;
}

bool ambiguous(const Match& match, const std::vector<Match>& matches,
               const std::vector<PlaneCandidate>& candidates, const AssociationGate& gate) {
  return std::any_of(matches.begin(), matches.end(), [&](const Match& other) {
    return other.observation == match.observation && other.candidate != match.candidate &&
           other.distance2 < match.distance2 + gate.ambiguity &&
           distinct(*candidates[match.candidate].plane, *candidates[other.candidate].plane, gate);
  });
}

}  // namespace

std::optional<double> planeDistance(const PlaneObservation& z, const SE3& T_map_body,
                                    const PlaneCandidate& candidate, const AssociationGate& gate) {
  const PlaneNode& plane = *candidate.plane;
  if ((T_map_body.rotation * z.normal_body).dot(plane.normal_map) < std::cos(gate.max_angle_rad))
    return std::nullopt;
  const PlaneResidual r = planeResidual(z, T_map_body, plane);
  Eigen::Matrix3d S = z.covariance + r.by_pose * candidate.pose_covariance * r.by_pose.transpose() +
                      r.by_plane * candidate.covariance * r.by_plane.transpose();
  S.diagonal().head<2>().array() += gate.surface_rad * gate.surface_rad;
  S(2, 2) += gate.surface_m * gate.surface_m;
  const double distance2 = r.value.dot(S.llt().solve(r.value));
  if (!(distance2 < gate.chi2)) return std::nullopt;
  // Along the plane the map may be off by the pose's own uncertainty.
  const double slack = 2 * std::sqrt(candidate.pose_covariance.topLeftCorner<3, 3>().trace());
  if (gapBetween(extentOn(plane, z, T_map_body), extentOf(plane)) > gate.max_gap_m + slack)
    return std::nullopt;
  if (std::abs(plane.normal_map.z()) < kPlumbNormal && gapUp(z, T_map_body, plane) > kMaxGapUp_m + slack)
    return std::nullopt;
  return distance2;
}

std::vector<std::optional<size_t>> associatePlanes(const std::vector<PlaneObservation>& observations,
                                                   const SE3& T_map_body,
                                                   const std::vector<PlaneCandidate>& candidates,
                                                   const AssociationGate& gate) {
  std::vector<Match> matches;
  for (size_t i = 0; i < observations.size(); ++i)
    for (size_t k = 0; k < candidates.size(); ++k)
      if (const auto distance2 = planeDistance(observations[i], T_map_body, candidates[k], gate))
        matches.push_back({*distance2, i, k});
  std::sort(matches.begin(), matches.end(), [](const Match& a, const Match& b) { return a.key() < b.key(); });

  std::vector<std::optional<size_t>> taken(observations.size());
  for (const Match& match : matches) {
    if (taken[match.observation] || ambiguous(match, matches, candidates, gate)) continue;
    const PlaneNode& plane = *candidates[match.candidate].plane;
    const Polygon2d extent = extentOn(plane, observations[match.observation], T_map_body);
    bool free = true;
    for (size_t i = 0; i < observations.size(); ++i)
      if (taken[i] == match.candidate && overlapMuch(extentOn(plane, observations[i], T_map_body), extent))
        free = false;
    if (free) taken[match.observation] = match.candidate;
  }
  return taken;
}

}  // namespace sgraphs
