#include "backend/planes/plane_pairs.h"

#include <algorithm>
#include <cmath>

#include "backend/planes/plane_extent.h"
#include "common/geometry/tangent_basis.h"

namespace sgraphs {
namespace {

constexpr double kParallel_rad = 0.05;
constexpr double kUpright = 0.07;  // |n.up| of a wall, and sine of the angle between a floor and level
constexpr double kMinThickness_m = 0.03, kMaxThickness_m = 0.6;
constexpr double kFacingShare = 0.3;  // of the smaller extent
constexpr double kOneHeight_m = 0.05;
constexpr double kTwinShare = 0.15;  // of the smaller extent: walls that meet at a bend share less
constexpr double kMaxTurned_rad = 0.1;
constexpr double kFloorArea_m2 = 4.0;

// From the centroid to the furthest corner.
double reachOf(const PlaneNode& plane) {
  double reach = 0;
  for (const Eigen::Vector3d& corner : plane.polygon_map)
    reach = std::max(reach, (corner - plane.centroid_map).norm());
  return reach;
}

}  // namespace

bool areOneSurface(const PlaneNode& a, const PlaneNode& b, const AssociationGate& gate,
                   double tilt_sigma_rad) {
  const double turned_rad = std::min(kMaxTurned_rad, 4 * gate.surface_rad + 3 * tilt_sigma_rad);
  const bool two_storeys = a.floor.valid() && b.floor.valid() && a.floor != b.floor;
  if (two_storeys || a.normal_map.dot(b.normal_map) < std::cos(turned_rad)) return false;
  if ((a.centroid_map - b.centroid_map).norm() > reachOf(a) + reachOf(b)) return false;
  // Judged where both were seen: away from there a small difference in tilt would count as distance.
  const Polygon2d own = extentOf(a), other = extentOn(a, b), both = intersection(own, other);
  if (both.empty()) return false;
  if (polygonArea(both) < kTwinShare * std::min(polygonArea(own), polygonArea(other))) return false;
  const Eigen::Vector3d p_map =
      a.anchor_map - a.offset_m * a.normal_map + tangentBasis(a.normal_map) * polygonCentroid(both);
  return std::abs(b.distance(p_map)) < 2.5 * gate.surface_m;
}

bool areFacesOfOneWall(const PlaneNode& a, const PlaneNode& b, const Eigen::Vector3d& up_map) {
  if (a.floor != b.floor || a.normal_map.dot(b.normal_map) > -std::cos(kParallel_rad)) return false;
  if (std::abs(a.normal_map.dot(up_map)) > kUpright || std::abs(b.normal_map.dot(up_map)) > kUpright)
    return false;
  // b lies behind a: a's normal points away from it.
  const double thickness = -a.distance(b.centroid_map);
  if (thickness < kMinThickness_m || thickness > kMaxThickness_m) return false;
  const Polygon2d own = extentOf(a), other = extentOn(a, b);
  return overlapArea(own, other) > kFacingShare * std::min(polygonArea(own), polygonArea(other));
}

bool areOneHeight(const PlaneNode& a, const PlaneNode& b, const Eigen::Vector3d& up_map) {
  const double up_a = a.normal_map.dot(up_map), up_b = b.normal_map.dot(up_map);
  const double level = std::cos(kUpright);
  if (a.floor != b.floor || up_a * up_b < 0 || std::min(std::abs(up_a), std::abs(up_b)) < level) return false;
  if (extentArea(a) < kFloorArea_m2 || extentArea(b) < kFloorArea_m2) return false;
  return std::abs(up_map.dot(a.centroid_map - b.centroid_map)) < kOneHeight_m;
}

}  // namespace sgraphs
