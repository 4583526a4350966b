#pragma once

#include <Eigen/Core>
#include <vector>

namespace sgraphs {

// Corners counter-clockwise, not closed.
using Polygon2d = std::vector<Eigen::Vector2d>;

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b);
// By the crossings of a ray: for any simple polygon, in either direction, not closed.
bool contains(const Polygon2d& polygon, const Eigen::Vector2d& p);
double distanceToSegment(const Eigen::Vector2d& p, const Eigen::Vector2d& a, const Eigen::Vector2d& b);

// Convex hull; empty if the points lie on a line.
Polygon2d convexHull(Polygon2d points);

// Signed: positive for counter-clockwise.
double polygonArea(const Polygon2d& polygon);

// Intersection of two convex polygons; empty if they do not meet.
Polygon2d intersection(const Polygon2d& a, const Polygon2d& b);
double overlapArea(const Polygon2d& a, const Polygon2d& b);

// Distance between two convex polygons; 0 if they meet.
double gapBetween(const Polygon2d& a, const Polygon2d& b);

// Centre of area; the mean of the corners if there is no area.
Eigen::Vector2d polygonCentroid(const Polygon2d& polygon);

// At most `corners` (at least 3) of a convex polygon: those are dropped whose loss costs the least area.
Polygon2d simplified(Polygon2d polygon, size_t corners);

}  // namespace sgraphs
