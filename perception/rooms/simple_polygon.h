#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/geometry/convex_polygon.h"

namespace sgraphs {

// Polygons here are simple, of either shape, counter-clockwise, not closed.

// The part of a polygon where normal.p + d >= 0. Where it falls apart, its pieces stay joined by edges of no
// area along the line, so that areas are right.
Polygon2d clipped(const Polygon2d& polygon, const Eigen::Vector2d& normal, double d);

// Distance to the outline; 0 inside.
double distanceTo(const Polygon2d& polygon, const Eigen::Vector2d& p);

// Area that two polygons share.
double sharedArea(const Polygon2d& a, const Polygon2d& b);

// Ends of what is left of an open line when corners nearer than tolerance_m to the rest are dropped (Douglas
// and Peucker): indices into points, ascending, first and last included.
std::vector<size_t> straightened(const Polygon2d& points, double tolerance_m);

}  // namespace sgraphs
