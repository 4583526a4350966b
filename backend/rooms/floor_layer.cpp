#include "backend/rooms/floor_layer.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "backend/rooms/center_binding.h"
#include "backend/rooms/floor_walls.h"

namespace sgraphs {
namespace {

constexpr double kLeastSize_m = 8;
// A room's offset from the storey's centre is taken anew when it has changed by more than this.
constexpr double kMovedOffset_m = 1.0;

// A power of two, so that it does not follow every wall that is found.
double sizeClass(double size_m) {
  return std::exp2(std::ceil(std::log2(std::max(kLeastSize_m, size_m))));
}

bool isSound(const FloorObservation& floor) {
  return floor.id.valid() && floor.center_map.norm() < kNoMapReaches_m &&
         (!floor.has_height || std::abs(floor.z_m) < kNoMapReaches_m);
}

}  // namespace

std::vector<std::string> FloorLayer::assign(const Rooms& rooms) {
  std::vector<std::string> refused;
  for (const FloorObservation& floor : rooms.floors) {
    if (isSound(floor))
      builder_.addFloor(floor.id);
    else
      refused.push_back("floor " + floor.id.str() + ": its id or place cannot be");
  }
  const SituationalGraph& graph = builder_.graph();
  std::vector<KeyframeFloor> changed;
  for (const KeyframeFloor& told : rooms.keyframe_floors) {
    const auto node = graph.keyframes.find(told.keyframe);
    if (node == graph.keyframes.end() || (told.floor.valid() && !graph.floors.contains(told.floor))) {
      refused.push_back("keyframe " + told.keyframe.str() + " on floor " + told.floor.str() +
                        ": one of them does not exist");
      continue;
    }
    if (node->second.floor == told.floor) continue;
    builder_.setFloor(told.keyframe, told.floor);
    changed.push_back(told);
  }
  if (!changed.empty()) assignPlanes(changed);
  return refused;
}

void FloorLayer::assignPlanes(const std::vector<KeyframeFloor>& changed) {
  const SituationalGraph& graph = builder_.graph();
  std::map<PlaneId, KeyframeId> first;
  for (const ObservationFactor& f : graph.observations) {
    const auto [known, fresh] = first.try_emplace(f.plane, f.keyframe);
    if (!fresh) known->second = std::min(known->second, f.keyframe);
  }
  std::map<KeyframeId, FloorId> now;
  for (const KeyframeFloor& c : changed) now[c.keyframe] = c.floor;
  for (const auto& [plane, keyframe] : first)
    if (const auto floor = now.find(keyframe); floor != now.end()) builder_.setFloor(plane, floor->second);
}

void FloorLayer::bind(const Rooms& rooms) {
  for (const FloorObservation& floor : rooms.floors)
    if (isSound(floor)) bindFloor(floor);
  withdraw(rooms);
}

void FloorLayer::bindFloor(const FloorObservation& floor) {
  const double size_m = config_.factors ? bindWalls(floor) : 0.0;
  builder_.setCenter({.room = {}, .floor = floor.id}, floor.center_map);
  bindHeight(floor);
  if (config_.factors) bindRooms(floor.id, sizeClass(size_m));
}

// Returns the storey's size. Nothing is bound before a keyframe is on the storey.
double FloorLayer::bindWalls(const FloorObservation& floor) {
  const SituationalGraph& graph = builder_.graph();
  const CenterOf of{.room = {}, .floor = floor.id};
  std::set<std::pair<PlaneId, PlaneId>> before;
  for (const CenterWallsFactor& f : graph.center_walls)
    if (f.of == of) before.insert(std::minmax(f.a, f.b));
  const FloorWalls walls = wallsOfFloor(graph, floor.id, before);
  const auto anchor = std::find_if(graph.keyframes.begin(), graph.keyframes.end(),
                                   [&](const auto& item) { return item.second.floor == floor.id; });
  if (anchor == graph.keyframes.end()) return walls.size_m;
  bindCenter({.of = of,
              .pairs = walls.pairs,
              .finite = false,
              .center_map = floor.center_map,
              .anchor = anchor->first,
              .height_m = anchor->second.T_map_body.translation.z(),
              .wall_sigma_m = wall_sigma_m_,
              .along_sigma_m = along_sigma_m_},
             builder_);
  return walls.size_m;
}

void FloorLayer::bindHeight(const FloorObservation& floor) {
  const SituationalGraph& graph = builder_.graph();
  const auto held = std::find_if(graph.floor_heights.begin(), graph.floor_heights.end(),
                                 [&](const FloorHeightFactor& f) { return f.floor == floor.id; });
  const PlaneId before = held == graph.floor_heights.end() ? PlaneId{} : held->plane;
  const PlaneId now =
      config_.factors && floor.has_height ? walkingSurface(graph, floor.id, floor.z_m, before) : PlaneId{};
  if (now != before && before.valid()) builder_.removeFactor(held->id);
  builder_.setHeight(floor.id, floor.has_height, floor.z_m);
  if (now != before && now.valid())
    builder_.addFloorHeight({.id = 0, .floor = floor.id, .plane = now, .sigma_m = config_.height_sigma_m});
}

void FloorLayer::bindRooms(FloorId floor, double size_m) {
  const SituationalGraph& graph = builder_.graph();
  if (!builder_.hasFactor({.room = {}, .floor = floor})) return;
  const Eigen::Vector2d center_map = graph.floors.at(floor).center_map;
  const auto offsetOf = [&](RoomId room) -> Eigen::Vector2d {
    return graph.rooms.at(room).center_map - center_map;
  };
  std::set<RoomId> bound;
  std::vector<int64_t> outdated;
  for (const FloorRoomFactor& f : graph.floor_rooms) {
    const bool here = graph.rooms.at(f.room).seen.floor == f.floor;
    if (f.floor != floor && here) continue;
    if (here && f.sigma_m == size_m && (offsetOf(f.room) - f.offset_map).norm() < kMovedOffset_m)
      bound.insert(f.room);
    else
      outdated.push_back(f.id);
  }
  for (const int64_t id : outdated) builder_.removeFactor(id);
  for (const auto& [id, room] : graph.rooms)
    if (room.seen.floor == floor && !bound.contains(id) && builder_.hasFactor({.room = id, .floor = {}}))
      builder_.addFloorRoom(
          {.id = 0, .floor = floor, .room = id, .offset_map = offsetOf(id), .sigma_m = size_m});
}

void FloorLayer::withdraw(const Rooms& rooms) {
  const SituationalGraph& graph = builder_.graph();
  std::set<FloorId> gone;
  for (const auto& [id, floor] : graph.floors) gone.insert(id);
  for (const FloorObservation& floor : rooms.floors) gone.erase(floor.id);
  for (const auto& [id, node] : graph.keyframes) gone.erase(node.floor);
  for (const auto& [id, plane] : graph.planes) gone.erase(plane.floor);
  for (const auto& [id, room] : graph.rooms) gone.erase(room.seen.floor);
  for (const FloorId id : gone) builder_.removeFloor(id);
}

}  // namespace sgraphs
