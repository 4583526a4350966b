#include "common/geometry/convex_polygon.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sgraphs {
namespace {

bool convexContains(const Polygon2d& polygon, const Eigen::Vector2d& p) {
  for (size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d& a = polygon[i];
    if (cross(polygon[(i + 1) % polygon.size()] - a, p - a) < 0) return false;
  }
  return true;
}

// Ends that touch are at distance 0 anyway.
bool segmentsCross(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c,
                   const Eigen::Vector2d& d) {
  return cross(b - a, c - a) * cross(b - a, d - a) < 0 && cross(d - c, a - c) * cross(d - c, b - c) < 0;
}

}  // namespace

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

bool contains(const Polygon2d& polygon, const Eigen::Vector2d& p) {
  bool inside = false;
  for (size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
    const Eigen::Vector2d &a = polygon[i], &b = polygon[j];
    if ((a.y() > p.y()) != (b.y() > p.y()) &&
        p.x() < a.x() + (p.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x()))
      inside = !inside;
  }
  return inside;
}

double distanceToSegment(const Eigen::Vector2d& p, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const double length2 = (b - a).squaredNorm();
  const double s = length2 > 0 ? std::clamp((p - a).dot(b - a) / length2, 0.0, 1.0) : 0.0;
  return (p - a - s * (b - a)).norm();
}

// Andrew's monotone chain.
Polygon2d convexHull(Polygon2d points) {
  const auto before = [](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    return a.x() < b.x() || (a.x() == b.x() && a.y() < b.y());
  };
  std::sort(points.begin(), points.end(), before);
  points.erase(std::unique(points.begin(), points.end()), points.end());
  if (points.size() < 3) return {};
  Polygon2d hull;
  const auto add = [&hull](const Eigen::Vector2d& p, size_t base) {
    while (hull.size() >= base + 2 && cross(hull.back() - hull[hull.size() - 2], p - hull.back()) <= 0)
      hull.pop_back();
    hull.push_back(p);
  };
  for (const Eigen::Vector2d& p : points) add(p, 0);
  const size_t lower = hull.size() - 1;
  for (size_t i = points.size() - 1; i-- > 0;) add(points[i], lower);
  hull.pop_back();
  return hull.size() < 3 ? Polygon2d{} : hull;
}

double polygonArea(const Polygon2d& polygon) {
  double twice = 0;
  for (size_t i = 0; i < polygon.size(); ++i) twice += cross(polygon[i], polygon[(i + 1) % polygon.size()]);
  return 0.5 * twice;
}

// Sutherland and Hodgman: a is cut by each edge of b.
Polygon2d intersection(const Polygon2d& a, const Polygon2d& b) {
  if (a.size() < 3 || b.size() < 3) return {};
  Polygon2d rest = a;
  for (size_t i = 0; i < b.size() && !rest.empty(); ++i) {
    const Eigen::Vector2d& from = b[i];
    const Eigen::Vector2d edge = b[(i + 1) % b.size()] - from;
    Polygon2d kept;
    for (size_t k = 0; k < rest.size(); ++k) {
      const Eigen::Vector2d& p = rest[k];
      const Eigen::Vector2d& q = rest[(k + 1) % rest.size()];
      const double side_p = cross(edge, p - from), side_q = cross(edge, q - from);
      if (side_p >= 0) kept.push_back(p);
      if ((side_p > 0 && side_q < 0) || (side_p < 0 && side_q > 0))
        kept.emplace_back(p + side_p / (side_p - side_q) * (q - p));
    }
    rest = std::move(kept);
  }
  return rest.size() < 3 ? Polygon2d{} : rest;
}

double overlapArea(const Polygon2d& a, const Polygon2d& b) {
  return std::max(0.0, polygonArea(intersection(a, b)));
}

double gapBetween(const Polygon2d& a, const Polygon2d& b) {
  if (a.empty() || b.empty()) return std::numeric_limits<double>::infinity();
  if ((a.size() > 2 && convexContains(a, b.front())) || (b.size() > 2 && convexContains(b, a.front())))
    return 0;
  double gap = std::numeric_limits<double>::infinity();
  for (size_t i = 0; i < a.size(); ++i)
    for (size_t k = 0; k < b.size(); ++k) {
      const Eigen::Vector2d &a0 = a[i], &a1 = a[(i + 1) % a.size()];
      const Eigen::Vector2d &b0 = b[k], &b1 = b[(k + 1) % b.size()];
      if (segmentsCross(a0, a1, b0, b1)) return 0;
      gap = std::min({gap, distanceToSegment(a0, b0, b1), distanceToSegment(b0, a0, a1)});
    }
  return gap;
}

Eigen::Vector2d polygonCentroid(const Polygon2d& polygon) {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& p : polygon) mean += p / static_cast<double>(polygon.size());
  Eigen::Vector2d moment = Eigen::Vector2d::Zero();
  double twice = 0;
  for (size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d a = polygon[i] - mean, b = polygon[(i + 1) % polygon.size()] - mean;
    twice += cross(a, b);
    moment += cross(a, b) * (a + b) / 3.0;
  }
  return std::abs(twice) < 1e-12 ? mean : Eigen::Vector2d(mean + moment / twice);
}

Polygon2d simplified(Polygon2d polygon, size_t corners) {
  while (polygon.size() > std::max<size_t>(3, corners)) {
    const size_t n = polygon.size();
    size_t cheapest = 0;
    double least = std::numeric_limits<double>::infinity();
    for (size_t i = 0; i < n; ++i) {
      const Eigen::Vector2d& a = polygon[(i + n - 1) % n];
      const double cost = std::abs(cross(polygon[i] - a, polygon[(i + 1) % n] - a));
      if (cost < least) {
        least = cost;
        cheapest = i;
      }
    }
    polygon.erase(polygon.begin() + static_cast<std::ptrdiff_t>(cheapest));
  }
  return polygon;
}

}  // namespace sgraphs
