#include "perception/rooms/floors.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "perception/rooms/simple_polygon.h"

namespace sgraphs {
namespace {

constexpr double kMinBelow_m = 0.15,
                 kMaxBelow_m = 1.5;  // of the walking surface under a walking robot's body
constexpr double kGuessBelow_m = 0.5;
constexpr double kSameSurface_m = 0.3;   // planes this far from the median are platforms or furniture
constexpr double kParallel_cos = 0.985;  // 10 degrees

struct Level {
  double z_m, area_m2;
};

Polygon2d outlineOf(const MapPlane& plane) {
  Polygon2d polygon;
  for (const Eigen::Vector3f& corner : plane.polygon_map) polygon.push_back(corner.head<2>().cast<double>());
  return polygon;
}

// Level planes that look up and lie under keyframes of a storey; the height that half of their area is below.
std::optional<double> surfaceBelow(const WallMap& map, const StoreyTracker& storeys, FloorId floor) {
  std::vector<Level> levels;
  for (const auto& [id, level] : map.levelPlanes()) {
    const auto& plane = level;  // a binding cannot be captured (clang 14)
    if (plane.normal_map.z() < 0) continue;
    const Polygon2d outline = outlineOf(plane);
    const bool walked_on =
        std::any_of(map.keyframes().begin(), map.keyframes().end(), [&](const auto& entry) {
          const Eigen::Vector3d& p = entry.second.T_map_body.translation;
          // Where the plane, which may slope a little, lies under the body.
          const double z =
              plane.centroid_map.z() -
              plane.normal_map.head<2>().dot((p - plane.centroid_map).head<2>()) / plane.normal_map.z();
          return storeys.floorOf(entry.first) == floor && p.z() - z > kMinBelow_m &&
                 p.z() - z < kMaxBelow_m && distanceTo(outline, p.head<2>()) < 0.5;
        });
    if (walked_on) levels.push_back({plane.centroid_map.z(), std::abs(polygonArea(outline))});
  }
  if (levels.empty()) return {};
  std::stable_sort(levels.begin(), levels.end(),
                   [](const Level& a, const Level& b) { return a.z_m < b.z_m; });
  double all = 0, below = 0;
  for (const Level& level : levels) all += level.area_m2;
  double median = levels.back().z_m;
  for (const Level& level : levels) {
    below += level.area_m2;
    if (below < 0.5 * all) continue;
    median = level.z_m;
    break;
  }
  double sum = 0, weight = 0;
  for (const Level& level : levels) {
    if (std::abs(level.z_m - median) > kSameSurface_m) continue;
    sum += (level.area_m2 + 1e-6) * level.z_m;
    weight += level.area_m2 + 1e-6;
  }
  return sum / weight;
}

// Middle between the outermost walls that face each other along a direction.
std::optional<double> middleAlong(const std::vector<Wall>& walls, const Eigen::Vector2d& direction) {
  double low = 0, high = 0;
  bool has_low = false, has_high = false;
  for (const Wall& wall : walls) {
    const double facing = wall.normal.dot(direction);
    if (std::abs(facing) < kParallel_cos) continue;
    const double at = direction.dot(wall.pointAt(0.5 * (wall.begin_m + wall.end_m)));
    if (facing > 0 && (!has_low || at < low)) low = at;
    if (facing < 0 && (!has_high || at > high)) high = at;
    (facing > 0 ? has_low : has_high) = true;
  }
  if (!has_low || !has_high || high <= low) return {};
  return 0.5 * (low + high);
}

// Between the widest opposed pairs along the longest wall and across it; what has none, from the bounding
// box of the walls.
Eigen::Vector2d centerOf(const std::vector<Wall>& walls) {
  if (walls.empty()) return Eigen::Vector2d::Zero();
  const Wall& longest = *std::max_element(
      walls.begin(), walls.end(), [](const Wall& a, const Wall& b) { return a.length() < b.length(); });
  Eigen::Vector2d center = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& axis : {longest.along, longest.normal}) {
    double low = 1e300, high = -1e300;
    for (const Wall& wall : walls)
      for (const double s : {wall.begin_m, wall.end_m}) {
        low = std::min(low, axis.dot(wall.pointAt(s)));
        high = std::max(high, axis.dot(wall.pointAt(s)));
      }
    center += middleAlong(walls, axis).value_or(0.5 * (low + high)) * axis;
  }
  return center;
}

}  // namespace

double surfaceOf(const FloorObservation& floor, const StoreyTracker& storeys) {
  if (floor.has_height) return floor.z_m;
  const auto body = storeys.bodyHeights().find(floor.id);
  return body == storeys.bodyHeights().end() ? 0.0 : body->second - kGuessBelow_m;
}

std::vector<FloorObservation> floorsOf(const WallMap& map, const StoreyTracker& storeys) {
  std::vector<FloorObservation> floors;
  double body_above_m = 0;
  int num_known = 0;
  for (const auto& [id, body_z] : storeys.bodyHeights()) {
    FloorObservation floor{id};
    if (const std::optional<double> z = surfaceBelow(map, storeys, id)) {
      floor.has_height = true;
      floor.z_m = *z;
      body_above_m += body_z - *z;
      ++num_known;
    }
    floors.push_back(floor);
  }
  for (FloorObservation& floor : floors) {
    if (!floor.has_height && num_known > 0) {
      floor.has_height = true;
      floor.z_m = storeys.bodyHeights().at(floor.id) - body_above_m / num_known;
    }
    const StoreyBand band = bandAbove(surfaceOf(floor, storeys));
    std::vector<Wall> walls;
    for (const auto& [id, wall] : map.walls())
      if (band.holds(wall)) walls.push_back(wall);
    floor.center_map = centerOf(walls);
  }
  return floors;
}

}  // namespace sgraphs
