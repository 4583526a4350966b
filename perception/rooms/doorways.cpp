#include "perception/rooms/doorways.h"

#include <algorithm>
#include <cmath>

namespace sgraphs {
namespace {

constexpr double kMaxOff_m = 0.7;      // a passage may be found so far from its wall's face
constexpr double kParallel_cos = 0.8;  // of the chord and the wall: 37 degrees, passages are short

// The face that a passage lies in, seen from one room; null if no wall is known there.
const Wall* faceAt(const Passage& passage, const RoomShape& room, const std::map<PlaneId, Wall>& walls) {
  const Eigen::Vector2d left = passage.left_map.cast<double>(), right = passage.right_map.cast<double>();
  const Eigen::Vector2d middle = 0.5 * (left + right), chord = (left - right).normalized();
  const Wall* best = nullptr;
  double least = kMaxOff_m;
  for (size_t i = 0; i < room.corners.size(); ++i) {
    const auto wall = walls.find(room.corners[i].wall);
    if (wall == walls.end() || std::abs(wall->second.along.dot(chord)) < kParallel_cos) continue;
    const double off =
        distanceToSegment(middle, room.polygon[i], room.polygon[(i + 1) % room.polygon.size()]);
    if (off >= least) continue;
    least = off;
    best = &wall->second;
  }
  return best;
}

Eigen::Vector2d middleOf(const Passage& passage, const Wall* face_a, const Wall* face_b) {
  const Eigen::Vector2d p = (0.5f * (passage.left_map + passage.right_map)).cast<double>();
  if (!face_a || !face_b || face_a->normal.dot(face_b->normal) > -0.9) return p;
  const MidPlane mid(*face_a, *face_b);
  return p - (mid.normal.dot(p) + mid.d) * mid.normal;
}

}  // namespace

std::vector<Doorway> doorwaysOf(const std::map<PassageId, Passage>& passages, const RoomTracker& rooms,
                                const std::map<PlaneId, Wall>& walls) {
  std::vector<Doorway> doorways;
  for (const auto& [id, passage] : passages) {
    if (!passage.is_door) continue;
    RoomId a = rooms.roomOf(passage.a), b = rooms.roomOf(passage.b);
    if (a == b) continue;  // both none, or one room
    if (!a.valid() || (b.valid() && b < a)) std::swap(a, b);
    const Wall* face_a = faceAt(passage, rooms.rooms().at(a).shape, walls);
    const Wall* face_b = b.valid() ? faceAt(passage, rooms.rooms().at(b).shape, walls) : nullptr;
    Doorway doorway{id, passage.floor, a, b};
    doorway.position_map << middleOf(passage, face_a, face_b), static_cast<double>(passage.z_m);
    doorway.width_m = static_cast<double>(passage.width_m());
    doorways.push_back(doorway);
  }
  return doorways;
}

}  // namespace sgraphs
