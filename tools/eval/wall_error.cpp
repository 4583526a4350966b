#include "tools/eval/wall_error.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <iterator>

#include "common/geometry/convex_polygon.h"
#include "tools/eval/plan_polygon.h"

namespace sgraphs {
namespace {

constexpr double kMaxAngle_rad = 5 * M_PI / 180;
constexpr double kMaxOffset_m = 0.05;
constexpr double kMinClaim_m2 = 0.5;      // a match covers this much of the face,
constexpr double kMinClaimShare = 0.5;    // or this share of the estimate
constexpr double kDoubledShare = 0.5;     // of the smaller claim
constexpr double kMinFalseArea_m2 = 0.5;  // smaller walls are not held against the map
constexpr double kOnSurface_m = 0.05;
constexpr double kOnSurfaceShare = 0.5;  // of a wall's extent that must lie on some surface
constexpr double kExtentSpacing_m = 0.1;

std::optional<WallMatch> matchOf(const TrueFace& face, const EstimatedWall& wall) {
  WallMatch match;
  const double cosine = std::clamp(face.normal().dot(wall.normal), -1.0, 1.0);
  match.angle_rad = std::acos(cosine);
  match.offset_m = face.distance(wall.centroid);
  if (match.angle_rad > kMaxAngle_rad || std::abs(match.offset_m) > kMaxOffset_m) return std::nullopt;
  Corners corners;
  for (const Eigen::Vector3d& p : wall.polygon) corners.push_back(face.onFace(p));
  for (size_t i = 0; i < face.samples.size(); ++i)
    if (face.samples[i].exposed && contains(corners, face.samples[i].at)) match.claimed.push_back(i);
  const double claimed_m2 = static_cast<double>(match.claimed.size()) * face.sample_area_m2;
  const double enough_m2 = std::min(kMinClaim_m2, kMinClaimShare * polygonArea(wall.polygon));
  if (match.claimed.empty() || claimed_m2 < enough_m2) return std::nullopt;
  return match;
}

bool claimTheSame(const WallMatch& a, const WallMatch& b) {
  std::vector<size_t> shared;
  std::set_intersection(a.claimed.begin(), a.claimed.end(), b.claimed.begin(), b.claimed.end(),
                        std::back_inserter(shared));
  const size_t smaller = std::min(a.claimed.size(), b.claimed.size());
  return static_cast<double>(shared.size()) > kDoubledShare * static_cast<double>(smaller);
}

bool onPane(const Eigen::Vector3d& p, const Plan& plan) {
  const auto is_on = [&](const TrueWall& wall) {
    return wall.glass && p.z() > wall.z_low_m - kOnSurface_m && p.z() < wall.z_high_m + kOnSurface_m &&
           distanceToSegment(p.head<2>(), wall.a, wall.b) <= 0.5 * wall.thickness_m + kOnSurface_m;
  };
  return std::any_of(plan.walls.begin(), plan.walls.end(), is_on) ||
         std::any_of(plan.panes.begin(), plan.panes.end(), is_on);
}

// Share of the wall's extent near some surface of the building, whatever it is; panes may not be in the mesh.
double shareOnSurface(const EstimatedWall& wall, const Plan& plan, const MeshQuery& mesh) {
  const Eigen::Vector3d u = wall.axis_u, v = wall.normal.cross(u);
  Corners corners;
  Eigen::Vector2d low = Eigen::Vector2d::Constant(INFINITY), high = -low;
  for (const Eigen::Vector3d& p : wall.polygon) {
    corners.emplace_back(u.dot(p - wall.centroid), v.dot(p - wall.centroid));
    low = low.cwiseMin(corners.back());
    high = high.cwiseMax(corners.back());
  }
  size_t inside = 0, near = 0;
  for (double x = low.x() + 0.5 * kExtentSpacing_m; x < high.x(); x += kExtentSpacing_m)
    for (double y = low.y() + 0.5 * kExtentSpacing_m; y < high.y(); y += kExtentSpacing_m) {
      if (!contains(corners, {x, y})) continue;
      ++inside;
      const Eigen::Vector3d p = wall.centroid + x * u + y * v;
      near += mesh.distance(p, kOnSurface_m).has_value() || onPane(p, plan);
    }
  return inside ? static_cast<double>(near) / static_cast<double>(inside) : 1.0;
}

void findMatches(WallResult& result) {
  result.found.assign(result.faces.size(), false);
  result.doubled.assign(result.faces.size(), false);
  std::vector<double> angles, offsets;
  for (size_t f = 0; f < result.faces.size(); ++f) {
    const size_t first = result.matches.size();
    for (size_t w = 0; w < result.walls.size(); ++w) {
      auto match = matchOf(result.faces[f], result.walls[w]);
      if (!match) continue;
      match->face = f;
      match->wall = w;
      for (size_t i = first; i < result.matches.size(); ++i)
        if (claimTheSame(result.matches[i], *match)) result.doubled[f] = true;
      result.found[f] = true;
      angles.push_back(match->angle_rad);
      offsets.push_back(std::abs(match->offset_m));
      result.matches.push_back(std::move(*match));
    }
  }
  result.angle_rad = statisticsOf(std::move(angles));
  result.offset_m = statisticsOf(std::move(offsets));
}

}  // namespace

WallResult::Counts WallResult::counts(bool of_asked) const {
  Counts counts;
  for (size_t f = 0; f < faces.size(); ++f) {
    if (asked(f) != of_asked) continue;
    ++counts.faces;
    ++(found[f] ? counts.found : counts.missed);
    counts.doubled += doubled[f];
  }
  return counts;
}

double polygonArea(const std::vector<Eigen::Vector3d>& polygon) {
  Eigen::Vector3d doubled = Eigen::Vector3d::Zero();
  for (size_t i = 1; i + 1 < polygon.size(); ++i)
    doubled += (polygon[i] - polygon[0]).cross(polygon[i + 1] - polygon[0]);
  return 0.5 * doubled.norm();
}

EstimatedWall moved(const EstimatedWall& wall, const SE3& T_other_map) {
  EstimatedWall result = wall;
  result.centroid = T_other_map * wall.centroid;
  for (Eigen::Vector3d* v : {&result.normal, &result.axis_u, &result.axis_v}) *v = T_other_map.rotation * *v;
  for (Eigen::Vector3d& p : result.polygon) p = T_other_map * p;
  return result;
}

WallResult judgeWalls(const Plan& plan, const MeshQuery& mesh, const std::vector<StampedPose>& truth,
                      const std::vector<EstimatedWall>& walls, const SE3& T_truth_map) {
  WallResult result;
  result.faces = trueFaces(plan, mesh);
  lookFromPath(truth, plan.T_body_lidar, mesh, result.faces);
  for (const EstimatedWall& wall : walls)
    if (wall.vertical()) result.walls.push_back(moved(wall, T_truth_map));
  findMatches(result);
  for (size_t w = 0; w < result.walls.size(); ++w)
    if (polygonArea(result.walls[w].polygon) > kMinFalseArea_m2 &&
        shareOnSurface(result.walls[w], plan, mesh) < kOnSurfaceShare)
      result.false_walls.push_back(w);
  return result;
}

}  // namespace sgraphs
