#include "perception/free_space/wall_cells.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sgraphs {
namespace {

constexpr double kMaxTilt = 0.2;         // of a wall's normal, its vertical part
constexpr double kHalfWidthCells = 1.2;  // hits of a wall lie in the cell of its face, or in the next

// Where a polygon's outline crosses a height, in order: inside lies between the first two, the next two, ...
std::vector<double> crossingsAt(const std::vector<Eigen::Vector2d>& outline, double height) {
  std::vector<double> crossings;
  for (size_t i = 0; i < outline.size(); ++i) {
    const Eigen::Vector2d &p = outline[i], &q = outline[(i + 1) % outline.size()];
    if ((p.y() > height) == (q.y() > height)) continue;
    crossings.push_back(p.x() + (q.x() - p.x()) * (height - p.y()) / (q.y() - p.y()));
  }
  std::sort(crossings.begin(), crossings.end());
  return crossings;
}

}  // namespace

bool WallTrace::near(const WallTrace& other, double tolerance_m) const {
  return floor == other.floor &&
         std::equal(pieces.begin(), pieces.end(), other.pieces.begin(), other.pieces.end(),
                    [tolerance_m](const Piece& a, const Piece& b) {
                      return (a.a_map - b.a_map).norm() < tolerance_m &&
                             (a.b_map - b.b_map).norm() < tolerance_m;
                    });
}

std::optional<WallTrace> wallTrace(const MapPlane& plane, double z_m, const EvidenceConfig& config) {
  if (plane.merged_into.valid() || !plane.floor.valid() || plane.polygon_map.size() < 3) return std::nullopt;
  if (!plane.normal_map.allFinite() || std::abs(plane.normal_map.z()) > kMaxTilt) return std::nullopt;
  const Eigen::Vector2d normal = plane.normal_map.head<2>().normalized();
  const Eigen::Vector2d along(-normal.y(), normal.x());
  const Eigen::Vector2d center = plane.centroid_map.head<2>();
  double first = std::numeric_limits<double>::max(), last = -first;
  std::vector<Eigen::Vector2d> outline;  // along, up
  for (const Eigen::Vector3f& corner : plane.polygon_map) {
    if (!corner.allFinite()) return std::nullopt;
    outline.emplace_back(along.dot(corner.head<2>().cast<double>() - center), corner.z());
    first = std::min(first, outline.back().x());
    last = std::max(last, outline.back().x());
  }
  if (last - first < config.min_wall_length_m) return std::nullopt;
  WallTrace trace;
  trace.floor = plane.floor;
  const std::vector<double> crossings = crossingsAt(outline, z_m);
  for (size_t i = 0; i + 1 < crossings.size(); i += 2)
    trace.pieces.push_back({center + crossings[i] * along, center + crossings[i + 1] * along});
  if (trace.pieces.empty()) return std::nullopt;
  return trace;
}

std::vector<std::pair<int, int>> wallCells(const WallTrace::Piece& piece, double cell_m) {
  std::vector<std::pair<int, int>> cells;
  const Eigen::Vector2d a = piece.a_map / cell_m, b = piece.b_map / cell_m;
  const double length = (b - a).norm();
  if (length < 1e-9) return cells;
  const Eigen::Vector2d along = (b - a) / length, normal(-along.y(), along.x());
  const Eigen::Vector2d low = a.cwiseMin(b), high = a.cwiseMax(b);
  const int x_end = static_cast<int>(std::floor(high.x() + kHalfWidthCells));
  const int y_end = static_cast<int>(std::floor(high.y() + kHalfWidthCells));
  for (int y = static_cast<int>(std::floor(low.y() - kHalfWidthCells)); y <= y_end; ++y)
    for (int x = static_cast<int>(std::floor(low.x() - kHalfWidthCells)); x <= x_end; ++x) {
      const Eigen::Vector2d d = Eigen::Vector2d(x + 0.5, y + 0.5) - a;
      const double u = along.dot(d);
      if (u >= 0 && u <= length && std::abs(normal.dot(d)) <= kHalfWidthCells) cells.emplace_back(x, y);
    }
  return cells;
}

}  // namespace sgraphs
