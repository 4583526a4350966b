#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/geometry/convex_polygon.h"

namespace sgraphs {

using Polygon = Polygon2d;

bool isSimple(const Polygon& polygon);

struct Outline {
  Polygon polygon;    // simple, counter-clockwise, not closed; empty for points on a line
  double filled = 0;  // share of the cells within that hold points
};

// Outline of points in a plane: the outer border of their grid cells with gaps up to `link_m` closed, with at
// most `max_corners` corners. A doorway that reaches the floor is a notch of it; a window, a hole, is not in
// it. Where parts touch at corners only, it is the convex hull.
Outline outlineOf(const std::vector<Eigen::Vector2d>& points, double cell_m, double link_m, int max_corners);

}  // namespace sgraphs
