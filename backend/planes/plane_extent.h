#pragma once

#include "backend/graph/situational_graph.h"
#include "common/geometry/convex_polygon.h"

namespace sgraphs {

// Extents are convex hulls, in the plane's coordinates (u, v) from its anchor, u, v = tangentBasis(normal).
inline constexpr size_t kMaxExtentCorners = 32;

Polygon2d extentOf(const PlaneNode& plane);
double extentArea(const PlaneNode& plane);
// The boundary of an observation laid on a mapped plane.
Polygon2d extentOn(const PlaneNode& plane, const PlaneObservation& z, const SE3& T_map_body);
// The extent of one mapped plane laid on another.
Polygon2d extentOn(const PlaneNode& plane, const PlaneNode& other);

// Makes polygon and centroid of the plane from the hull of these points. The covariance, if there was an
// extent before, is carried to the new centroid.
void setExtent(PlaneNode& plane, Polygon2d points);

}  // namespace sgraphs
