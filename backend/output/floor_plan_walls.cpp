#include <Eigen/Geometry>
#include <algorithm>
#include <utility>

#include "backend/output/floor_level.h"
#include "backend/output/floor_plan.h"
#include "backend/output/map_cloud.h"

namespace sgraphs {
namespace {

constexpr double kHeightStep_m = 0.125;  // the extent is looked at on level lines this far apart
constexpr double kMinLength_m = 0.05;
constexpr double kGap_m = 0.05;  // narrower ones are closed

// Corners of an extent: along the wall, and height over the walking surface.
using Corners = std::vector<Eigen::Vector2d>;
using Intervals = std::vector<std::pair<double, double>>;

// Where a level line lies inside the extent.
Intervals insideAt(const Corners& corners, double height) {
  std::vector<double> crossings;
  for (size_t i = 0, j = corners.size() - 1; i < corners.size(); j = i++) {
    const Eigen::Vector2d &a = corners[j], &b = corners[i];
    if ((a.y() > height) == (b.y() > height)) continue;
    crossings.push_back(a.x() + (height - a.y()) / (b.y() - a.y()) * (b.x() - a.x()));
  }
  std::sort(crossings.begin(), crossings.end());
  Intervals inside;
  for (size_t i = 0; i + 1 < crossings.size(); i += 2) inside.emplace_back(crossings[i], crossings[i + 1]);
  return inside;
}

Intervals united(Intervals intervals) {
  std::sort(intervals.begin(), intervals.end());
  Intervals result;
  for (const auto& interval : intervals) {
    if (!result.empty() && interval.first <= result.back().second + kGap_m)
      result.back().second = std::max(result.back().second, interval.second);
    else
      result.push_back(interval);
  }
  return result;
}

Intervals stretchesInSlice(const Corners& corners) {
  Intervals all;
  for (double h = kPlanSliceLow_m; h <= kPlanSliceHigh_m; h += kHeightStep_m)
    for (const auto& interval : insideAt(corners, h)) all.push_back(interval);
  return united(std::move(all));
}

}  // namespace

std::vector<FloorPlan::WallLine> wallLines(const SituationalGraph& graph, const FloorNode& floor) {
  const StoreyHeight height(graph, floor);
  std::vector<FloorPlan::WallLine> lines;
  for (const auto& [id, plane] : graph.planes) {
    const FloorId here = plane.floor.valid() ? plane.floor : FloorId{0};
    if (plane.label == PlaneLabel::kHorizontal || here != floor.id || plane.polygon_map.size() < 3) continue;
    // Level and in the plane; seen from above the observer is on its left.
    const Eigen::Vector3d along = plane.normal_map.cross(graph.up_map).normalized();
    Corners corners;
    for (const Eigen::Vector3d& p : plane.polygon_map)
      corners.emplace_back(along.dot(p - plane.centroid_map), height.above(p));
    for (const auto& [begin, end] : stretchesInSlice(corners)) {
      if (end - begin < kMinLength_m) continue;
      lines.push_back(
          {id, (plane.centroid_map + begin * along).head<2>(), (plane.centroid_map + end * along).head<2>()});
    }
  }
  return lines;
}

}  // namespace sgraphs
