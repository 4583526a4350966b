#include "perception/rooms/room_finder.h"

#include <algorithm>

#include "perception/rooms/doorways.h"

namespace sgraphs {
namespace {

// A robot stands in a room if its body is in, or on the threshold.
constexpr double kEntered_m = 0.3;
// A room keeps its keyframe until another is nearer by this.
constexpr double kNearer_m = 1.0;

bool sameBorder(const FreeSpaceCluster& a, const FreeSpaceCluster& b) {
  return a.is_corridor == b.is_corridor && a.floor == b.floor &&
         std::equal(a.border.begin(), a.border.end(), b.border.begin(), b.border.end(),
                    [](const BorderCorner& p, const BorderCorner& q) {
                      return p.position_map == q.position_map && p.kind == q.kind;
                    });
}

Eigen::AlignedBox2d boxOf(const Wall& wall) {
  return Eigen::AlignedBox2d(wall.pointAt(wall.begin_m)).extend(wall.pointAt(wall.end_m));
}

}  // namespace

RoomFinder::RoomFinder(const RoomsConfig& config)
    : config_(config), storeys_({config.climb_slope, config.same_storey_m}), tracker_(config) {}

Rooms RoomFinder::step(const FreeSpace& free_space, const MapUpdate& update) {
  Rooms result;
  result.round = update.round;
  result.time = update.time;
  map_.apply(update);
  result.keyframe_floors = storeys_.step(map_.keyframes());
  if (!update.keyframes.empty() || !update.planes.empty()) floors_ = floorsOf(map_, storeys_);
  result.floors = floors_;
  resolveWalls();
  tracker_.step(update.time, candidatesOf(free_space, floors_), unsupported());
  for (auto& [id, room] : tracker_.rooms()) {
    placeAnchor(room);
    result.rooms.push_back(observationOf(room));
  }
  result.doorways = doorwaysOf(free_space.passages, tracker_, map_.walls());
  return result;
}

std::vector<RoomCandidate> RoomFinder::candidatesOf(const FreeSpace& free_space,
                                                    const std::vector<FloorObservation>& floors) {
  std::vector<RoomCandidate> candidates;
  std::erase_if(cache_, [&](const auto& entry) { return free_space.clusters.count(entry.first) == 0; });
  for (const auto& [id, cluster] : free_space.clusters) {
    const auto floor = std::find_if(floors.begin(), floors.end(),
                                    [id = cluster.floor](const FloorObservation& f) { return f.id == id; });
    if (floor == floors.end()) continue;
    const std::optional<RoomShape>& shape = shapeOf(cluster, bandAbove(surfaceOf(*floor, storeys_)));
    if (!shape) continue;
    const bool entered = tracker_.roomOf(id).valid() || wasEntered(*shape, cluster.floor);
    candidates.push_back({id, cluster.floor, &*shape, entered});
  }
  return candidates;
}

const std::optional<RoomShape>& RoomFinder::shapeOf(const FreeSpaceCluster& cluster, const StoreyBand& band) {
  Cached& cached = cache_[cluster.id];
  const bool known = cached.cluster.id.valid() && sameBorder(cached.cluster, cluster);
  if (!known) {
    cached.cluster = cluster;
    cached.reach.setEmpty();
    for (const BorderCorner& corner : cluster.border) cached.reach.extend(corner.position_map.cast<double>());
    const Eigen::Vector2d margin =
        Eigen::Vector2d::Constant(std::max(kLowFurniture_m, config_.furniture_depth_m) + 0.2);
    if (!cached.reach.isEmpty())
      cached.reach = Eigen::AlignedBox2d(cached.reach.min() - margin, cached.reach.max() + margin);
  }
  std::vector<Wall> walls;
  std::vector<int64_t> changes;
  for (const auto& [id, wall] : map_.walls()) {
    if (!band.holds(wall) || !map_.isRecent(wall, config_.window_keyframes)) continue;
    if (!cached.reach.intersects(boxOf(wall))) continue;
    walls.push_back(wall);
    walls.back().low = band.isLow(wall);
    changes.push_back(wall.changed);
  }
  if (known && changes == cached.walls) return cached.shape;
  cached.walls = std::move(changes);
  cached.shape = roomShapeOf(cluster, walls, config_);
  return cached.shape;
}

bool RoomFinder::wasEntered(const RoomShape& shape, FloorId floor) const {
  return std::any_of(map_.keyframes().begin(), map_.keyframes().end(), [&](const auto& entry) {
    return storeys_.floorOf(entry.first) == floor &&
           distanceTo(shape.polygon, entry.second.T_map_body.translation.template head<2>()) < kEntered_m;
  });
}

// With a window, walls fade from what rooms are made of, but not from the map: a room stays while its cluster
// and its walls do.
std::vector<ClusterId> RoomFinder::unsupported() const {
  std::vector<ClusterId> kept;
  if (config_.window_keyframes == 0) return kept;
  for (const auto& [id, room] : tracker_.rooms()) {
    const std::vector<PlaneId> walls = room.shape.walls();
    const bool stand =
        std::all_of(walls.begin(), walls.end(), [&](PlaneId w) { return map_.walls().count(w) > 0; });
    if (stand && cache_.count(room.cluster) > 0) kept.push_back(room.cluster);
  }
  return kept;
}

// Walls of rooms live on in those they were merged into.
void RoomFinder::resolveWalls() {
  for (auto& [id, room] : tracker_.rooms()) {
    for (RoomCorner& corner : room.shape.corners) corner.wall = map_.resolve(corner.wall);
    for (auto& [a, b] : room.shape.pairs) {
      a = map_.resolve(a);
      b = map_.resolve(b);
    }
  }
}

void RoomFinder::placeAnchor(TrackedRoom& room) const {
  const auto distance = [&](const MapKeyframe& keyframe) {
    return (keyframe.T_map_body.translation.head<2>() - room.shape.free_center_map).norm();
  };
  const auto current = map_.keyframes().find(room.anchor);
  double least = current == map_.keyframes().end() ? 1e300 : distance(current->second) - kNearer_m;
  for (const auto& [id, keyframe] : map_.keyframes()) {
    if (storeys_.floorOf(id) != room.floor || distance(keyframe) >= least) continue;
    least = distance(keyframe);
    room.anchor = id;
  }
}

RoomObservation RoomFinder::observationOf(const TrackedRoom& room) const {
  RoomObservation observation;
  observation.id = room.id;
  observation.kind = room.shape.kind;
  observation.floor = room.floor;
  observation.accepted = room.accepted;
  observation.polygon = room.shape.corners;
  observation.center_map = room.shape.center_map;
  observation.area_m2 = room.shape.area_m2;
  observation.pairs = room.shape.pairs;
  observation.free_center_map = room.shape.free_center_map;
  observation.anchor = room.anchor;
  return observation;
}

}  // namespace sgraphs
