// Rooms and storeys of GraphBuilder.
#include <algorithm>
#include <utility>

#include "backend/factors/center_anchor_cost.h"
#include "backend/factors/center_walls_cost.h"
#include "backend/factors/floor_height_cost.h"
#include "backend/factors/floor_room_cost.h"
#include "backend/factors/room_shape_cost.h"
#include "backend/graph_builder.h"

namespace sgraphs {
namespace {

template <typename Factor>
bool erased(std::vector<Factor>& factors, int64_t id) {
  return std::erase_if(factors, [id](const Factor& f) { return f.id == id; }) > 0;
}

template <typename Factor, typename Predicate>
void collect(const std::vector<Factor>& factors, Predicate predicate, std::vector<int64_t>& ids) {
  for (const Factor& factor : factors)
    if (predicate(factor)) ids.push_back(factor.id);
}

}  // namespace

void GraphBuilder::putRoom(const RoomObservation& seen) {
  const auto [room, fresh] = graph_.rooms.try_emplace(seen.id);
  room->second.id = seen.id;
  room->second.seen = seen;
  if (fresh) room->second.center_map = seen.center_map;
}

void GraphBuilder::removeRoom(RoomId id) {
  const CenterOf of{.room = id, .floor = {}};
  std::vector<int64_t> ids;
  collect(
      graph_.center_walls, [&](const auto& f) { return f.of == of; }, ids);
  collect(
      graph_.center_anchors, [&](const auto& f) { return f.of == of; }, ids);
  collect(
      graph_.room_shapes, [&](const auto& f) { return f.room == id; }, ids);
  collect(
      graph_.floor_rooms, [&](const auto& f) { return f.room == id; }, ids);
  for (const int64_t factor : ids) removeFactor(factor);
  if (const auto state = room_states_.find(id); state != room_states_.end()) {
    center_of_state_.erase(state->second);
    room_states_.erase(state);
  }
  graph_.rooms.erase(id);
}

void GraphBuilder::removeFloor(FloorId id) {
  const CenterOf of{.room = {}, .floor = id};
  std::vector<int64_t> ids;
  collect(
      graph_.center_walls, [&](const auto& f) { return f.of == of; }, ids);
  collect(
      graph_.center_anchors, [&](const auto& f) { return f.of == of; }, ids);
  collect(
      graph_.floor_heights, [&](const auto& f) { return f.floor == id; }, ids);
  collect(
      graph_.floor_rooms, [&](const auto& f) { return f.floor == id; }, ids);
  for (const int64_t factor : ids) removeFactor(factor);
  if (const auto state = floor_states_.find(id); state != floor_states_.end()) {
    center_of_state_.erase(state->second);
    floor_states_.erase(state);
  }
  if (const auto state = height_states_.find(id); state != height_states_.end()) {
    height_of_state_.erase(state->second);
    height_states_.erase(state);
  }
  graph_.floors.erase(id);
}

bool GraphBuilder::hasFactor(const CenterOf& of) const {
  const auto isOf = [&](const auto& f) { return f.of == of; };
  return std::any_of(graph_.center_walls.begin(), graph_.center_walls.end(), isOf) ||
         std::any_of(graph_.center_anchors.begin(), graph_.center_anchors.end(), isOf);
}

void GraphBuilder::setCenter(const CenterOf& of, const Eigen::Vector2d& center_map) {
  if (hasFactor(of)) return;
  (of.room.valid() ? graph_.rooms.at(of.room).center_map : graph_.floors.at(of.floor).center_map) =
      center_map;
}

void GraphBuilder::setHeight(FloorId floor, bool has_height, double z_m) {
  FloorNode& node = graph_.floors.at(floor);
  const bool held = std::any_of(graph_.floor_heights.begin(), graph_.floor_heights.end(),
                                [&](const FloorHeightFactor& f) { return f.floor == floor; });
  if (held) return;
  node.has_height = has_height;
  node.z_m = has_height ? z_m : 0.0;
}

GraphBuilder::StateId GraphBuilder::centerState(const CenterOf& of) {
  StateId* known = nullptr;
  bool fresh = false;
  if (of.room.valid()) {
    const auto [it, inserted] = room_states_.try_emplace(of.room, -1);
    known = &it->second;
    fresh = inserted;
  } else {
    const auto [it, inserted] = floor_states_.try_emplace(of.floor, -1);
    known = &it->second;
    fresh = inserted;
  }
  if (!fresh) return *known;
  *known = solver_.addCenter(of.room.valid() ? graph_.rooms.at(of.room).center_map
                                             : graph_.floors.at(of.floor).center_map);
  center_of_state_[*known] = of;
  return *known;
}

void GraphBuilder::addCenterWalls(CenterWallsFactor factor) {
  const std::string kind =
      factor.of.floor.valid() ? "floor_wall" : (factor.finite ? "room_wall" : "room_wall_infinite");
  factor.id = add(kind, CenterWallsCost::Create(factor.height_m, factor.sigma_m),
                  {centerState(factor.of), plane_states_.at(factor.a), plane_states_.at(factor.b)}, {});
  graph_.center_walls.push_back(factor);
}

void GraphBuilder::addCenterAnchor(CenterAnchorFactor factor) {
  factor.id = add(factor.of.floor.valid() ? "floor_wall" : "room_wall_infinite",
                  CenterAnchorCost::Create(factor.center_body, factor.along_body, factor.sigma_m),
                  {centerState(factor.of), keyframe_states_.at(factor.keyframe)}, {});
  graph_.center_anchors.push_back(factor);
}

void GraphBuilder::addRoomShape(RoomShapeFactor factor) {
  const auto kind = factor.square ? RoomShapeCost::Kind::kSquare : RoomShapeCost::Kind::kParallel;
  factor.id = add("room_shape", RoomShapeCost::Create(kind, factor.sigma_rad),
                  {plane_states_.at(factor.a), plane_states_.at(factor.b)}, kCauchy1);
  graph_.room_shapes.push_back(factor);
}

void GraphBuilder::addFloorHeight(FloorHeightFactor factor) {
  FloorNode& floor = graph_.floors.at(factor.floor);
  const auto [state, fresh] = height_states_.try_emplace(factor.floor, -1);
  if (fresh) {
    state->second = solver_.addHeight(floor.z_m);
    height_of_state_[state->second] = factor.floor;
  }
  floor.has_height = true;
  factor.id = add("floor_height", FloorHeightCost::Create(factor.sigma_m),
                  {state->second, plane_states_.at(factor.plane)}, {});
  graph_.floor_heights.push_back(factor);
}

void GraphBuilder::addFloorRoom(FloorRoomFactor factor) {
  factor.id =
      add("floor_room", FloorRoomCost::Create(factor.offset_map, factor.sigma_m),
          {centerState({.room = {}, .floor = factor.floor}), centerState({.room = factor.room, .floor = {}})},
          {});
  graph_.floor_rooms.push_back(factor);
}

void GraphBuilder::removeFactor(int64_t id) {
  if (erased(graph_.center_walls, id) || erased(graph_.center_anchors, id) ||
      erased(graph_.room_shapes, id) || erased(graph_.floor_heights, id) || erased(graph_.floor_rooms, id))
    drop(id);
}

// A factor between the two, or one that `into` has already, is void.
void GraphBuilder::mergeInRooms(PlaneId from, PlaneId into, StateId old_state, StateId state) {
  const auto rebind = [&](auto& factors, const auto& same) {
    const auto before = std::exchange(factors, {});
    for (auto f : before) {
      if (f.a == from || f.b == from) {
        (f.a == from ? f.a : f.b) = into;
        const bool twice = std::any_of(before.begin(), before.end(), [&](const auto& g) {
          return g.id != f.id && same(f, g) && std::minmax(f.a, f.b) == std::minmax(g.a, g.b);
        });
        if (f.a == f.b || twice) {
          drop(f.id);
          continue;
        }
        solver_.rebind(factors_.at(f.id).factor, old_state, state);
      }
      factors.push_back(f);
    }
  };
  rebind(graph_.center_walls,
         [](const CenterWallsFactor& f, const CenterWallsFactor& g) { return f.of == g.of; });
  rebind(graph_.room_shapes, [](const RoomShapeFactor&, const RoomShapeFactor&) { return true; });
  for (FloorHeightFactor& f : graph_.floor_heights) {
    if (f.plane != from) continue;
    solver_.rebind(factors_.at(f.id).factor, old_state, state);
    f.plane = into;
  }
  for (auto& [id, room] : graph_.rooms) {
    for (RoomCorner& corner : room.seen.polygon)
      if (corner.wall == from) corner.wall = into;
    for (auto& [a, b] : room.seen.pairs) {
      if (a == from) a = into;
      if (b == from) b = into;
    }
  }
}

void GraphBuilder::takeOverCenter(StateId state) {
  if (const auto of = center_of_state_.find(state); of != center_of_state_.end()) {
    const CenterOf& id = of->second;
    (id.room.valid() ? graph_.rooms.at(id.room).center_map : graph_.floors.at(id.floor).center_map) =
        solver_.center(state);
  }
  if (const auto floor = height_of_state_.find(state); floor != height_of_state_.end())
    graph_.floors.at(floor->second).z_m = solver_.height(state);
}

}  // namespace sgraphs
