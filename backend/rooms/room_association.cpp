#include "backend/rooms/room_association.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

namespace sgraphs {
namespace {

constexpr double kSameFacing = 0.98;     // cosine: heading drifts less than 11 degrees
constexpr double kSameDistance_m = 0.1;  // of a wall from the room's centre: several sigma of its place
constexpr double kLeastWidthShare = 1.0 / 3;
constexpr size_t kLeastWalls = 3;

// The walls that make the room: of a finite one the four.
std::vector<PlaneId> makers(const RoomObservation& room) {
  if (room.kind != RoomKind::kFinite) return room.walls();
  std::set<PlaneId> walls;
  for (const auto& [a, b] : room.pairs) walls.insert({a, b});
  return {walls.begin(), walls.end()};
}

double distanceFrom(const Eigen::Vector2d& center_map, const PlaneNode& wall) {
  return wall.distance({center_map.x(), center_map.y(), wall.centroid_map.z()});
}

}  // namespace

std::optional<std::vector<std::pair<PlaneId, PlaneId>>> wallsOfSameRoom(
    const RoomObservation& a, const RoomObservation& b, const std::map<PlaneId, PlaneNode>& planes,
    double max_apart_m) {
  if (a.floor != b.floor || a.kind != b.kind || a.kind == RoomKind::kInfinite) return std::nullopt;
  const double apart_m = (a.center_map - b.center_map).norm();
  if (apart_m > max_apart_m) return std::nullopt;
  const std::vector<PlaneId> walls_a = makers(a), walls_b = makers(b);
  if (walls_a.size() != walls_b.size() || walls_a.size() < kLeastWalls) return std::nullopt;
  std::vector<std::pair<PlaneId, PlaneId>> matches;
  std::set<PlaneId> taken;
  double reach = std::numeric_limits<double>::infinity();
  for (const PlaneId id_a : walls_a) {
    const PlaneNode& wall_a = planes.at(id_a);
    const double distance = distanceFrom(a.center_map, wall_a);
    reach = std::min(reach, distance);
    const auto same = std::find_if(walls_b.begin(), walls_b.end(), [&](PlaneId id_b) {
      const PlaneNode& wall_b = planes.at(id_b);
      return !taken.contains(id_b) && wall_a.normal_map.dot(wall_b.normal_map) > kSameFacing &&
             std::abs(distance - distanceFrom(b.center_map, wall_b)) < kSameDistance_m;
    });
    if (same == walls_b.end()) return std::nullopt;
    taken.insert(*same);
    matches.emplace_back(id_a, *same);
  }
  if (apart_m > kLeastWidthShare * 2 * reach) return std::nullopt;
  return matches;
}

}  // namespace sgraphs
