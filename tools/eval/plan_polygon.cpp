#include "tools/eval/plan_polygon.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "common/geometry/convex_polygon.h"

namespace sgraphs {
namespace {

constexpr double kMinArea_m2 = 0.01;
constexpr double kThinnestSlab_m = 1e-12;

using Interval = std::pair<double, double>;

// Pieces of one polygon on the line at y, appended.
void addInsideAt(const Corners& polygon, double y, std::vector<Interval>& pieces) {
  std::vector<double> crossings;
  for (size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
    const Eigen::Vector2d &a = polygon[i], &b = polygon[j];
    if ((a.y() > y) != (b.y() > y))
      crossings.push_back(a.x() + (b.x() - a.x()) * (y - a.y()) / (b.y() - a.y()));
  }
  std::sort(crossings.begin(), crossings.end());
  for (size_t i = 0; i + 1 < crossings.size(); i += 2) pieces.emplace_back(crossings[i], crossings[i + 1]);
}

double sharedLength(const std::vector<Interval>& a, const std::vector<Interval>& b) {
  double length = 0;
  for (size_t i = 0, j = 0; i < a.size() && j < b.size();) {
    length += std::max(0.0, std::min(a[i].second, b[j].second) - std::max(a[i].first, b[j].first));
    ++(a[i].second < b[j].second ? i : j);
  }
  return length;
}

struct Edge {
  Eigen::Vector2d from, to;
};

// Where both edges cross inside of each other; none for parallel ones.
std::optional<Eigen::Vector2d> crossing(const Edge& a, const Edge& b) {
  const Eigen::Vector2d along_a = a.to - a.from, along_b = b.to - b.from;
  const double det = cross(along_a, along_b);
  if (std::abs(det) <= 1e-12 * along_a.norm() * along_b.norm()) return std::nullopt;
  const double s = cross(b.from - a.from, along_b) / det, t = cross(b.from - a.from, along_a) / det;
  constexpr double kEnd = 1e-9;
  if (s <= kEnd || s >= 1 - kEnd || t <= kEnd || t >= 1 - kEnd) return std::nullopt;
  return a.from + s * along_a;
}

void addEdges(const Corners& polygon, std::vector<Edge>& edges) {
  for (size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++)
    edges.push_back({polygon[j], polygon[i]});
}

// Heights between which no edge begins, ends or crosses another.
std::vector<double> slabBorders(const std::vector<Edge>& edges) {
  std::vector<double> borders;
  for (size_t i = 0; i < edges.size(); ++i) {
    borders.push_back(edges[i].from.y());
    for (size_t j = 0; j < i; ++j)
      if (const auto p = crossing(edges[i], edges[j])) borders.push_back(p->y());
  }
  std::sort(borders.begin(), borders.end());
  return borders;
}

}  // namespace

std::vector<Interval> insideAt(const std::vector<Corners>& polygons, double y) {
  std::vector<Interval> pieces;
  for (const Corners& polygon : polygons) addInsideAt(polygon, y, pieces);
  std::sort(pieces.begin(), pieces.end());
  std::vector<Interval> apart;
  for (const Interval& piece : pieces) {
    if (apart.empty() || piece.first > apart.back().second)
      apart.push_back(piece);
    else
      apart.back().second = std::max(apart.back().second, piece.second);
  }
  return apart;
}

// Between two borders all lengths change evenly with y, so that the one half-way is their mean.
double sharedArea(const std::vector<Corners>& a, const std::vector<Corners>& b) {
  std::vector<Edge> edges;
  for (const auto* polygons : {&a, &b})
    for (const Corners& polygon : *polygons) addEdges(polygon, edges);
  const auto borders = slabBorders(edges);
  double area = 0;
  for (size_t i = 1; i < borders.size(); ++i) {
    const double height = borders[i] - borders[i - 1];
    if (height < kThinnestSlab_m) continue;
    const double y = 0.5 * (borders[i] + borders[i - 1]);
    area += height * sharedLength(insideAt(a, y), insideAt(b, y));
  }
  return area;
}

double areaOf(const Corners& polygon) {
  return sharedArea({polygon}, {polygon});
}

double intersectionOverUnion(const Corners& a, const Corners& b) {
  const double shared = sharedArea({a}, {b});
  const double all = areaOf(a) + areaOf(b) - shared;
  return all > 0 ? shared / all : 0;
}

std::string whyNoOutline(const Corners& polygon) {
  if (polygon.size() < 3) return "has less than three corners";
  std::vector<Edge> edges;
  addEdges(polygon, edges);
  for (size_t i = 0; i < edges.size(); ++i)
    for (size_t j = 0; j < i; ++j)
      if (crossing(edges[i], edges[j])) return "has an outline that crosses itself";
  if (areaOf(polygon) < kMinArea_m2) return "has no area";
  return {};
}

}  // namespace sgraphs
