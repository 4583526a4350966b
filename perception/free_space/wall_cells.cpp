#include "perception/free_space/wall_cells.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sgraphs {
namespace {

constexpr double kMaxTilt = 0.2;         // of a wall's normal, its vertical part
constexpr double kHalfWidthCells = 1.2;  // hits of a wall lie in the cell of its face, or in the next

}  // namespace

bool WallLine::near(const WallLine& other, double tolerance_m) const {
  return floor == other.floor && (a_map - other.a_map).norm() < tolerance_m &&
         (b_map - other.b_map).norm() < tolerance_m;
}

std::optional<WallLine> wallLine(const MapPlane& plane, const EvidenceConfig& config) {
  if (plane.merged_into.valid() || !plane.floor.valid() || plane.polygon_map.size() < 3) return std::nullopt;
  if (!plane.normal_map.allFinite() || std::abs(plane.normal_map.z()) > kMaxTilt) return std::nullopt;
  const Eigen::Vector2d normal = plane.normal_map.head<2>().normalized();
  const Eigen::Vector2d along(-normal.y(), normal.x());
  const Eigen::Vector2d center = plane.centroid_map.head<2>();
  double first = std::numeric_limits<double>::max(), last = -first;
  WallLine line;
  line.top_z_m = -std::numeric_limits<double>::max();
  for (const Eigen::Vector3f& corner : plane.polygon_map) {
    if (!corner.allFinite()) return std::nullopt;
    const double u = along.dot(corner.head<2>().cast<double>() - center);
    first = std::min(first, u);
    last = std::max(last, u);
    line.top_z_m = std::max(line.top_z_m, static_cast<double>(corner.z()));
  }
  if (last - first < config.min_wall_length_m) return std::nullopt;
  line.floor = plane.floor;
  line.a_map = center + first * along;
  line.b_map = center + last * along;
  return line;
}

std::vector<std::pair<int, int>> wallCells(const WallLine& line, double cell_m) {
  std::vector<std::pair<int, int>> cells;
  const Eigen::Vector2d a = line.a_map / cell_m, b = line.b_map / cell_m;
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
