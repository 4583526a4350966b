#include "perception/rooms/doorways.h"

#include <algorithm>
#include <cmath>

namespace sgraphs {
namespace {

constexpr double kMinWidth_m = 0.3;     // nobody passes a narrower one
constexpr double kMaxOff_m = 0.7;       // a passage may be found so far from its wall's face
constexpr double kOpenEnd = 1.3;        // a side this much wider than its passage has no jambs
constexpr double kAlongWall_cos = 0.5;  // of the chord and the wall: jambs may not face each other

struct Threshold {
  const Wall* face = nullptr;  // null: no wall is known there
  double side_m = 0;           // length of the room's side that the passage is in; 0: in none
};

// Where a passage meets a room: of the sides along its chord the nearest, walls first.
Threshold thresholdAt(const Passage& passage, const RoomShape& room, const std::map<PlaneId, Wall>& walls) {
  const Eigen::Vector2d left = passage.left_map.cast<double>(), right = passage.right_map.cast<double>();
  const Eigen::Vector2d middle = 0.5 * (left + right), chord = (left - right).normalized();
  Threshold best;
  double least = kMaxOff_m;
  for (size_t i = 0; i < room.polygon.size(); ++i) {
    const Eigen::Vector2d &a = room.polygon[i], &b = room.polygon[(i + 1) % room.polygon.size()];
    const double off = distanceToSegment(middle, a, b);
    if (off >= kMaxOff_m || std::abs((b - a).normalized().dot(chord)) < kAlongWall_cos) continue;
    const auto wall = walls.find(room.corners[i].wall);
    const Wall* face = wall == walls.end() ? nullptr : &wall->second;
    if ((best.face && !face) || (off >= least && !(face && !best.face))) continue;
    least = off;
    best = {face, (b - a).norm()};
  }
  return best;
}

Eigen::Vector2d footOn(const Wall& wall, const Eigen::Vector2d& p) {
  return p - wall.distance(p) * wall.normal;
}

Eigen::Vector2d middleOf(const Passage& passage, const Wall* face_a, const Wall* face_b) {
  const Eigen::Vector2d p = (0.5f * (passage.left_map + passage.right_map)).cast<double>();
  if (face_a && face_b && face_a->normal.dot(face_b->normal) < -0.9) {
    const MidPlane mid(*face_a, *face_b);
    return p - (mid.normal.dot(p) + mid.d) * mid.normal;
  }
  const Wall* face = face_a ? face_a : face_b;
  return face ? footOn(*face, p) : p;
}

bool isOpenEnd(const Threshold& a, const Threshold& b, const Passage& passage) {
  const double open_m = kOpenEnd * static_cast<double>(passage.width_m());
  return !a.face && !b.face && ((a.side_m > 0 && a.side_m < open_m) || (b.side_m > 0 && b.side_m < open_m));
}

}  // namespace

std::vector<Doorway> doorwaysOf(const std::map<PassageId, Passage>& passages, const RoomTracker& rooms,
                                const std::map<PlaneId, Wall>& walls) {
  std::vector<Doorway> doorways;
  for (const auto& [id, passage] : passages) {
    if (!passage.is_door || static_cast<double>(passage.width_m()) < kMinWidth_m) continue;
    RoomId a = rooms.roomOf(passage.a), b = rooms.roomOf(passage.b);
    if (a == b) continue;  // both none, or one room
    if (!a.valid() || (b.valid() && b < a)) std::swap(a, b);
    const Threshold at_a = thresholdAt(passage, rooms.rooms().at(a).shape, walls);
    const Threshold at_b = b.valid() ? thresholdAt(passage, rooms.rooms().at(b).shape, walls) : Threshold{};
    if (isOpenEnd(at_a, at_b, passage)) continue;
    Doorway doorway{id, passage.floor, a, b};
    doorway.position_map << middleOf(passage, at_a.face, at_b.face), static_cast<double>(passage.z_m);
    doorway.width_m = static_cast<double>(passage.width_m());
    doorways.push_back(doorway);
  }
  return doorways;
}

}  // namespace sgraphs
