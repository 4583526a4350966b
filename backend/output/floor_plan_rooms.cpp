#include <algorithm>
#include <cmath>
#include <limits>

#include "backend/output/floor_plan.h"
#include "common/geometry/convex_polygon.h"

namespace sgraphs {
namespace {

constexpr double kLabelStep_m = 0.25;
constexpr int kMaxLabelSteps = 200;  // along the longer side

double distanceToOutline(const Polygon2d& outline, const Eigen::Vector2d& p) {
  double nearest = std::numeric_limits<double>::infinity();
  for (size_t i = 0, j = outline.size() - 1; i < outline.size(); j = i++)
    nearest = std::min(nearest, distanceToSegment(p, outline[j], outline[i]));
  return nearest;
}

// Where a name has most room: the raster point inside that is farthest from the outline; of equals, the one
// nearest to the middle.
void placeLabel(FloorPlan::Room& room) {
  Eigen::Vector2d low = room.polygon.front(), high = low;
  for (const Eigen::Vector2d& corner : room.polygon) {
    low = low.cwiseMin(corner);
    high = high.cwiseMax(corner);
  }
  const double step = std::max(kLabelStep_m, (high - low).maxCoeff() / kMaxLabelSteps);
  const Eigen::Vector2d middle = 0.5 * (low + high);
  double best = -std::numeric_limits<double>::infinity();
  for (double y = low.y() + 0.5 * step; y < high.y(); y += step)
    for (double x = low.x() + 0.5 * step; x < high.x(); x += step) {
      const Eigen::Vector2d p(x, y);
      if (!contains(room.polygon, p)) continue;
      const double free = distanceToOutline(room.polygon, p);
      const double rank = std::min(free, 1.0) - 0.01 * (p - middle).norm();
      if (rank <= best) continue;
      best = rank;
      room.label_at = p;
      room.room_for_label_m = free;
    }
}

}  // namespace

std::vector<FloorPlan::Room> planRooms(const SituationalGraph& graph, FloorId floor) {
  std::vector<FloorPlan::Room> rooms;
  for (const auto& [id, node] : graph.rooms) {
    if (node.seen.floor != floor || node.seen.polygon.size() < 3) continue;
    FloorPlan::Room room;
    room.id = id;
    for (const RoomCorner& corner : node.seen.polygon) room.polygon.push_back(corner.position_map);
    room.area_m2 = node.seen.area_m2;
    room.corridor = node.seen.kind == RoomKind::kInfinite;
    placeLabel(room);
    rooms.push_back(std::move(room));
  }
  return rooms;
}

std::vector<FloorPlan::Door> planDoors(const SituationalGraph& graph, FloorId floor) {
  std::vector<FloorPlan::Door> doors;
  for (const auto& [id, doorway] : graph.doorways) {
    if (doorway.floor != floor) continue;
    FloorPlan::Door door{doorway.position_map.head<2>(), doorway.position_map.head<2>(), doorway.width_m};
    // The doorway lies where its passage does; its width is drawn along the passage.
    Eigen::Vector2d along(1, 0);
    if (graph.free_space)
      if (const auto passage = graph.free_space->passages.find(id);
          passage != graph.free_space->passages.end()) {
        const Eigen::Vector2f across = passage->second.right_map - passage->second.left_map;
        if (across.norm() > 0) along = across.cast<double>().normalized();
      }
    door.left -= 0.5 * doorway.width_m * along;
    door.right += 0.5 * doorway.width_m * along;
    doors.push_back(door);
  }
  return doors;
}

}  // namespace sgraphs
