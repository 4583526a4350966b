#include "backend/planes/plane_extent.h"

#include "backend/planes/plane_residual.h"
#include "common/geometry/tangent_basis.h"

namespace sgraphs {

Polygon2d extentOf(const PlaneNode& plane) {
  return extentOn(plane, plane);
}

double extentArea(const PlaneNode& plane) {
  return polygonArea(extentOf(plane));
}

Polygon2d extentOn(const PlaneNode& plane, const PlaneObservation& z, const SE3& T_map_body) {
  const TangentBasis in_body = tangentBasis(z.normal_body), axes = tangentBasis(plane.normal_map);
  Polygon2d points;
  for (const Eigen::Vector2f& corner : z.boundary) {
    const Eigen::Vector3d p_map = T_map_body * (z.centroid_body + in_body * corner.cast<double>());
    points.emplace_back(axes.transpose() * (p_map - plane.anchor_map));
  }
  return convexHull(std::move(points));
}

Polygon2d extentOn(const PlaneNode& plane, const PlaneNode& other) {
  const TangentBasis axes = tangentBasis(plane.normal_map);
  Polygon2d points;
  for (const Eigen::Vector3d& p_map : other.polygon_map)
    points.emplace_back(axes.transpose() * (p_map - plane.anchor_map));
  return convexHull(std::move(points));
}

void setExtent(PlaneNode& plane, Polygon2d points) {
  const Polygon2d hull = simplified(convexHull(std::move(points)), kMaxExtentCorners);
  const TangentBasis axes = tangentBasis(plane.normal_map);
  const Eigen::Vector3d origin = plane.anchor_map - plane.offset_m * plane.normal_map;
  const bool had_extent = !plane.polygon_map.empty();
  plane.polygon_map.clear();
  for (const Eigen::Vector2d& p : hull) plane.polygon_map.emplace_back(origin + axes * p);
  if (hull.empty()) return;
  const Eigen::Vector3d centroid = origin + axes * polygonCentroid(hull);
  if (had_extent)
    plane.covariance = alongNormal(
        movedCovariance(alongNormal(plane.covariance), plane.normal_map, plane.centroid_map, centroid));
  plane.centroid_map = centroid;
}

}  // namespace sgraphs
