#include "perception/rooms/simple_polygon.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>

#include "common/geometry/simplify_chain.h"

namespace sgraphs {

Polygon2d clipped(const Polygon2d& polygon, const Eigen::Vector2d& normal, double d) {
  Polygon2d kept;
  kept.reserve(polygon.size() + 2);
  for (size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d& p = polygon[i];
    const Eigen::Vector2d& q = polygon[(i + 1) % polygon.size()];
    const double side_p = normal.dot(p) + d, side_q = normal.dot(q) + d;
    if (side_p >= 0) kept.push_back(p);
    if ((side_p > 0 && side_q < 0) || (side_p < 0 && side_q > 0))
      kept.emplace_back(p + side_p / (side_p - side_q) * (q - p));
  }
  if (kept.size() < 3) kept.clear();
  return kept;
}

double distanceTo(const Polygon2d& polygon, const Eigen::Vector2d& p) {
  if (contains(polygon, p)) return 0;
  double least = std::numeric_limits<double>::infinity();
  for (size_t i = 0; i < polygon.size(); ++i)
    least = std::min(least, distanceToSegment(p, polygon[i], polygon[(i + 1) % polygon.size()]));
  return least;
}

// Each polygon is a signed sum of triangles from one point to its edges; the triangles meet pair by pair.
double sharedArea(const Polygon2d& a, const Polygon2d& b) {
  if (a.size() < 3 || b.size() < 3) return 0;
  const auto boxOf = [](const Polygon2d& polygon) {
    Eigen::AlignedBox2d box;
    for (const Eigen::Vector2d& p : polygon) box.extend(p);
    return box;
  };
  if (!boxOf(a).intersects(boxOf(b))) return 0;
  const Eigen::Vector2d& apex = a.front();
  struct Triangle {
    Polygon2d corners;
    double sign;
  };
  const auto fan = [&apex](const Polygon2d& polygon) {
    std::vector<Triangle> triangles;
    for (size_t i = 0; i < polygon.size(); ++i) {
      const Eigen::Vector2d& p = polygon[i];
      const Eigen::Vector2d& q = polygon[(i + 1) % polygon.size()];
      const double twice = cross(p - apex, q - apex);
      if (twice > 1e-12) triangles.push_back({{apex, p, q}, 1.0});
      if (twice < -1e-12) triangles.push_back({{apex, q, p}, -1.0});
    }
    return triangles;
  };
  const std::vector<Triangle> fan_a = fan(a), fan_b = fan(b);
  double area = 0;
  for (const Triangle& s : fan_a)
    for (const Triangle& t : fan_b) area += s.sign * t.sign * overlapArea(s.corners, t.corners);
  return std::max(0.0, area);
}

std::vector<size_t> straightened(const Polygon2d& points, double tolerance_m) {
  if (points.empty()) return {};
  std::vector<uint8_t> kept(points.size(), 0);
  kept.front() = kept.back() = 1;
  simplifyChain(points, 0, points.size() - 1, tolerance_m, kept);
  std::vector<size_t> indices;
  for (size_t i = 0; i < kept.size(); ++i)
    if (kept[i]) indices.push_back(i);
  return indices;
}

}  // namespace sgraphs
