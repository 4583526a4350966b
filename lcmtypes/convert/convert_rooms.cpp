#include <cmath>
#include <stdexcept>

#include "lcmtypes/convert/chunks.h"
#include "lcmtypes/convert/convert_layers.h"

namespace sgraphs {
namespace {

constexpr size_t kMaxRoomCorners = 1000;
constexpr size_t kMaxPairs = 2;

room_t toMessage(const RoomObservation& room) {
  if (room.polygon.size() > kMaxRoomCorners || room.pairs.size() > kMaxPairs)
    throw std::logic_error("room " + room.id.str() + " has more corners or pairs than a message holds");
  room_t m{};
  m.id = room.id.value;
  m.kind = static_cast<int8_t>(room.kind);
  m.floor = room.floor.value;
  m.accepted_utime = room.accepted.us;
  for (const RoomCorner& corner : room.polygon) {
    m.polygon.push_back({corner.position_map.x(), corner.position_map.y()});
    m.wall.push_back(corner.wall.value);
  }
  m.num_corners = static_cast<int32_t>(m.polygon.size());
  for (const auto& [a, b] : room.pairs) m.pairs.push_back({a.value, b.value});
  m.num_pairs = static_cast<int32_t>(m.pairs.size());
  for (int i = 0; i < 2; ++i) {
    m.center[i] = room.center_map[i];
    m.free_center[i] = room.free_center_map[i];
  }
  m.area_m2 = room.area_m2;
  m.anchor_keyframe = room.anchor.value;
  return m;
}

bool isKind(int8_t kind) {
  return kind == room_t::INFINITE || kind == room_t::FINITE || kind == room_t::POLYGON;
}

std::optional<RoomObservation> fromMessage(const room_t& m) {
  if (m.id < 0 || m.floor < -1 || !isKind(m.kind) || m.polygon.size() < 3 ||
      m.polygon.size() > kMaxRoomCorners || m.pairs.size() > kMaxPairs || m.anchor_keyframe < -1)
    return std::nullopt;
  RoomObservation room;
  room.id = RoomId{m.id};
  room.kind = static_cast<RoomKind>(m.kind);
  room.floor = FloorId{m.floor};
  room.accepted = Time{m.accepted_utime};
  room.center_map = Eigen::Vector2d(m.center);
  room.free_center_map = Eigen::Vector2d(m.free_center);
  room.area_m2 = m.area_m2;
  room.anchor = KeyframeId{m.anchor_keyframe};
  bool valid = room.center_map.allFinite() && room.free_center_map.allFinite() && room.area_m2 > 0 &&
               std::isfinite(room.area_m2);
  for (size_t i = 0; i < m.polygon.size(); ++i) {
    room.polygon.push_back({{m.polygon[i][0], m.polygon[i][1]}, PlaneId{m.wall[i]}});
    valid = valid && room.polygon.back().position_map.allFinite() && m.wall[i] >= -1;
  }
  for (const auto& pair : m.pairs) {
    room.pairs.emplace_back(PlaneId{pair[0]}, PlaneId{pair[1]});
    valid = valid && pair[0] >= 0 && pair[1] >= 0 && pair[0] != pair[1];
  }
  if (!valid) return std::nullopt;
  return room;
}

doorway_t toMessage(const Doorway& doorway) {
  doorway_t m{};
  m.id = doorway.id.value;
  m.floor = doorway.floor.value;
  m.room_a = doorway.a.value;
  m.room_b = doorway.b.value;
  for (int i = 0; i < 3; ++i) m.position[i] = doorway.position_map[i];
  m.width_m = doorway.width_m;
  return m;
}

std::optional<Doorway> fromMessage(const doorway_t& m) {
  const Doorway doorway{
      PassageId{m.id}, FloorId{m.floor}, RoomId{m.room_a}, RoomId{m.room_b}, Eigen::Vector3d(m.position),
      m.width_m};
  if (m.id < 0 || m.floor < -1 || m.room_a < 0 || m.room_b < -1 || m.room_a == m.room_b ||
      !doorway.position_map.allFinite() || !(m.width_m > 0) || !std::isfinite(m.width_m))
    return std::nullopt;
  return doorway;
}

floor_t toMessage(const FloorObservation& floor) {
  floor_t m{};
  m.id = floor.id.value;
  m.has_height = floor.has_height;
  m.z_m = floor.has_height ? floor.z_m : 0;
  for (int i = 0; i < 2; ++i) m.center[i] = floor.center_map[i];
  return m;
}

std::optional<FloorObservation> fromMessage(const floor_t& m) {
  const FloorObservation floor{FloorId{m.id}, m.has_height != 0, m.z_m, Eigen::Vector2d(m.center)};
  if (m.id < 0 || !std::isfinite(m.z_m) || !floor.center_map.allFinite()) return std::nullopt;
  return floor;
}

template <typename Record, typename Node>
bool readInto(const std::vector<Record>& records, std::vector<Node>& nodes) {
  for (const Record& record : records) {
    std::optional<Node> node = fromMessage(record);
    if (!node || (!nodes.empty() && node->id <= nodes.back().id)) return false;
    nodes.push_back(std::move(*node));
  }
  return true;
}

}  // namespace

std::vector<rooms_t> toMessages(const Rooms& rooms, const std::string& why_not) {
  rooms_t head{};
  head.header.utime = rooms.time.us;
  head.round = rooms.round;
  head.why_not = why_not;
  ChunkFiller<rooms_t> chunks(head);
  for (const RoomObservation& room : rooms.rooms) chunks.add(&rooms_t::rooms, toMessage(room));
  for (const Doorway& doorway : rooms.doorways) chunks.add(&rooms_t::doorways, toMessage(doorway));
  for (const FloorObservation& floor : rooms.floors) chunks.add(&rooms_t::floors, toMessage(floor));
  for (const KeyframeFloor& keyframe : rooms.keyframe_floors)
    chunks.add(&rooms_t::keyframe, keyframe.keyframe.value, &rooms_t::keyframe_floor, keyframe.floor.value);
  return chunks.finish([](rooms_t& m) {
    m.num_rooms = static_cast<int32_t>(m.rooms.size());
    m.num_doorways = static_cast<int32_t>(m.doorways.size());
    m.num_floors = static_cast<int32_t>(m.floors.size());
    m.num_keyframes = static_cast<int32_t>(m.keyframe.size());
  });
}

std::optional<Rooms> fromMessages(std::span<const rooms_t> chunks) {
  if (chunks.empty() || chunks.front().round < 0) return std::nullopt;
  Rooms rooms{.round = chunks.front().round,
              .time = Time{chunks.front().header.utime},
              .rooms = {},
              .doorways = {},
              .floors = {},
              .keyframe_floors = {}};
  for (const rooms_t& m : chunks) {
    if (m.round != rooms.round || !readInto(m.rooms, rooms.rooms) || !readInto(m.doorways, rooms.doorways) ||
        !readInto(m.floors, rooms.floors))
      return std::nullopt;
    for (size_t i = 0; i < m.keyframe.size(); ++i) {
      if (m.keyframe[i] < 0 || m.keyframe_floor[i] < -1) return std::nullopt;
      rooms.keyframe_floors.push_back({KeyframeId{m.keyframe[i]}, FloorId{m.keyframe_floor[i]}});
    }
  }
  return rooms;
}

}  // namespace sgraphs
