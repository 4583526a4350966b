#include "backend/output/graph_layers_json.h"

#include <limits>
#include <set>

#include "backend/graph/map_plane.h"

namespace sgraphs {
namespace {

using Json = nlohmann::ordered_json;

const char* kindName(RoomKind kind) {
  switch (kind) {
    case RoomKind::kInfinite:
      return "infinite";
    case RoomKind::kFinite:
      return "finite";
    case RoomKind::kPolygon:
      return "polygon";
  }
  throw std::logic_error("unknown kind of room");
}

std::set<PlaneId> wallsOf(const SituationalGraph& graph, const RoomNode& room) {
  std::set<PlaneId> walls;
  for (const PlaneId wall : room.seen.walls())
    if (const PlaneId living = livingPlane(graph, wall); living.valid()) walls.insert(living);
  return walls;
}

FloorId storeyOf(FloorId floor) {
  return floor.valid() ? floor : FloorId{0};
}

Json roomJson(const SituationalGraph& graph, const RoomNode& room, std::span<const SessionClock> sessions) {
  Json polygon = Json::array(), walls = Json::array();
  for (const RoomCorner& corner : room.seen.polygon)
    polygon.push_back({corner.position_map.x(), corner.position_map.y()});
  for (const PlaneId wall : wallsOf(graph, room)) walls.push_back(wall.str());
  Json json = {{"id", room.id.str()},
               {"layer", "rooms"},
               {"kind", kindName(room.seen.kind)},
               {"center", {room.center_map.x(), room.center_map.y()}},
               {"polygon", std::move(polygon)},
               {"area", room.seen.area_m2},
               {"walls", std::move(walls)},
               {"floor", storeyOf(room.seen.floor).str()},
               {"utime", recordedTime(sessions, room.seen.accepted).us}};
  if (sessions.size() > 1) json["session"] = sessionAt(sessions, room.seen.accepted);
  return json;
}

Json vertexJson(const FreeSpaceVertex& vertex) {
  return {{"id", vertex.id.str()},
          {"layer", "free_space"},
          {"xyz", {vertex.position_map.x(), vertex.position_map.y(), vertex.position_map.z()}},
          {"clearance", vertex.clearance_m},
          {"cluster", vertex.cluster.value},
          {"floor", storeyOf(vertex.floor).str()}};
}

// The vertex of the storey nearest to the doorway's middle; invalid: there is none.
VertexId vertexBehind(const SituationalGraph& graph, const Doorway& doorway) {
  VertexId nearest;
  double best = std::numeric_limits<double>::infinity();
  if (graph.free_space)
    for (const auto& [id, vertex] : graph.free_space->vertices) {
      const double distance = (vertex.position_map.cast<double>() - doorway.position_map).norm();
      if (vertex.floor != doorway.floor || distance >= best) continue;
      best = distance;
      nearest = id;
    }
  return nearest;
}

void addDoorway(const SituationalGraph& graph, const Doorway& doorway, Json& links) {
  const bool between_rooms = graph.rooms.contains(doorway.a) && graph.rooms.contains(doorway.b);
  const VertexId behind = between_rooms ? VertexId{} : vertexBehind(graph, doorway);
  if (!graph.rooms.contains(doorway.a) || (!between_rooms && !behind.valid())) return;
  links.push_back({{"source", doorway.a.str()},
                   {"target", between_rooms ? doorway.b.str() : behind.str()},
                   {"kind", "doorway"},
                   {"id", doorway.id.str()},
                   {"xyz", {doorway.position_map.x(), doorway.position_map.y(), doorway.position_map.z()}},
                   {"width", doorway.width_m}});
}

}  // namespace

void addUpperLayerNodes(const SituationalGraph& graph, std::span<const SessionClock> sessions, Json& nodes) {
  for (const auto& [id, room] : graph.rooms) nodes.push_back(roomJson(graph, room, sessions));
  if (graph.free_space)
    for (const auto& [id, vertex] : graph.free_space->vertices) nodes.push_back(vertexJson(vertex));
}

void addUpperLayerLinks(const SituationalGraph& graph, Json& links) {
  for (const auto& [id, room] : graph.rooms) {
    for (const PlaneId wall : wallsOf(graph, room))
      links.push_back({{"source", id.str()}, {"target", wall.str()}, {"kind", "room_wall"}});
    if (graph.floors.contains(room.seen.floor))
      links.push_back({{"source", id.str()}, {"target", room.seen.floor.str()}, {"kind", "room_floor"}});
  }
  for (const auto& [id, plane] : graph.planes)
    if (plane.label != PlaneLabel::kHorizontal && graph.floors.contains(plane.floor))
      links.push_back({{"source", plane.floor.str()}, {"target", id.str()}, {"kind", "floor_wall"}});
  for (const auto& [id, doorway] : graph.doorways) addDoorway(graph, doorway, links);
  if (!graph.free_space) return;
  for (const auto& [id, vertex] : graph.free_space->vertices)
    for (const VertexId neighbour : vertex.neighbours)
      if (id < neighbour && graph.free_space->vertices.contains(neighbour))
        links.push_back({{"source", id.str()}, {"target", neighbour.str()}, {"kind", "free_space"}});
}

}  // namespace sgraphs
