#include "backend/rooms/room_changes.h"

#include <cmath>

namespace sgraphs {
namespace {

constexpr double kAnnounceStep_m = 1e-3;

bool apart(const std::vector<double>& a, const std::vector<double>& b) {
  if (a.size() != b.size()) return true;
  for (size_t i = 0; i < a.size(); ++i)
    if (std::abs(a[i] - b[i]) > kAnnounceStep_m) return true;
  return false;
}

}  // namespace

bool RoomChanges::take(const SituationalGraph& graph) {
  std::map<Key, Announced> now;
  for (const auto& [id, room] : graph.rooms) {
    Announced& a = now[{'r', id.value}];
    a.ids = {static_cast<int64_t>(room.seen.kind), room.seen.floor.value};
    a.places_m = {room.center_map.x(), room.center_map.y()};
    for (const RoomCorner& corner : room.seen.polygon) {
      a.ids.push_back(corner.wall.value);
      a.places_m.insert(a.places_m.end(), {corner.position_map.x(), corner.position_map.y()});
    }
    for (const auto& [wall_a, wall_b] : room.seen.pairs)
      a.ids.insert(a.ids.end(), {wall_a.value, wall_b.value});
  }
  for (const auto& [id, doorway] : graph.doorways) {
    const Eigen::Vector3d& p = doorway.position_map;
    now[{'d', id.value}] = {{doorway.floor.value, doorway.a.value, doorway.b.value},
                            {p.x(), p.y(), p.z(), doorway.width_m}};
  }
  for (const auto& [id, floor] : graph.floors)
    now[{'f', id.value}] = {{floor.has_height}, {floor.center_map.x(), floor.center_map.y(), floor.z_m}};

  bool changed = false;
  for (auto& [key, a] : now) {
    const auto before = announced_.find(key);
    if (before != announced_.end() && before->second.ids == a.ids &&
        !apart(before->second.places_m, a.places_m))
      a = before->second;  // small steps add up
    else
      changed = true;
  }
  changed = changed || now.size() != announced_.size();
  announced_ = std::move(now);
  return changed;
}

}  // namespace sgraphs
