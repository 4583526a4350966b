#pragma once

#include <Eigen/Core>
#include <string>
#include <utility>
#include <vector>

#include "common/geometry/convex_polygon.h"

namespace sgraphs {

// A polygon that need not be convex, not closed, either way around; inside is what the even-odd rule says.
using Corners = std::vector<Eigen::Vector2d>;

// Where the line at this y is inside one of the polygons: from x to x, ascending, apart from each other.
std::vector<std::pair<double, double>> insideAt(const std::vector<Corners>& polygons, double y);

// Area of what lies both in any of `a` and in any of `b`; exact.
double sharedArea(const std::vector<Corners>& a, const std::vector<Corners>& b);

double areaOf(const Corners& polygon);
double intersectionOverUnion(const Corners& a, const Corners& b);

// Why this is the outline of no room; empty if it is one.
std::string whyNoOutline(const Corners& polygon);

}  // namespace sgraphs
