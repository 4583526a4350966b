#include "backend/rooms/room_layer.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "backend/graph/map_plane.h"
#include "backend/rooms/center_binding.h"
#include "backend/rooms/room_association.h"

namespace sgraphs {
namespace {

// So many rounds in a row must take two rooms for one before their walls are merged: it is not undone.
constexpr int kTwinRounds = 2;
// Opposed walls face each other: within 60 degrees.
constexpr double kOpposed = -0.5;

bool isFinite(const RoomObservation& room) {
  const auto near = [](const Eigen::Vector2d& p) { return p.norm() < kNoMapReaches_m; };  // false for NaN
  for (const RoomCorner& corner : room.polygon)
    if (!near(corner.position_map)) return false;
  return near(room.center_map) && near(room.free_center_map) && std::isfinite(room.area_m2);
}

}  // namespace

RoomLayer::Outcome RoomLayer::apply(const Rooms& rooms) {
  Outcome outcome;
  std::vector<RoomObservation> seen = usable(rooms, outcome.refused);
  if (config_.factors) {
    outcome.merged = mergeDuplicates(seen);
    absorb(seen);
  }
  withdraw(seen);
  for (const RoomObservation& room : seen) {
    builder_.putRoom(room);
    bind(room);
  }
  bindShapes();
  putDoorways(rooms.doorways);
  return outcome;
}

// In the order of their ids, walls as they are nodes now.
std::vector<RoomObservation> RoomLayer::usable(const Rooms& rooms, std::vector<std::string>& refused) const {
  const SituationalGraph& graph = builder_.graph();
  std::map<RoomId, RoomObservation> seen;
  for (const RoomObservation& room : rooms.rooms) {
    const bool sound = room.id.valid() && isFinite(room) && graph.floors.contains(room.floor);
    if (!sound || graph.keyframes.empty() || !seen.emplace(room.id, room).second)
      refused.push_back("room " + room.id.str() + ": its id, storey or place cannot be");
  }
  std::vector<RoomObservation> sound;
  for (auto& [id, room] : seen) {
    resolve(room);
    sound.push_back(std::move(room));
  }
  return sound;
}

// Observations are of an earlier map: planes may have been merged since.
void RoomLayer::resolve(RoomObservation& room) const {
  const SituationalGraph& graph = builder_.graph();
  for (RoomCorner& corner : room.polygon) corner.wall = livingPlane(graph, corner.wall);
  for (auto& [a, b] : room.pairs) {
    a = livingPlane(graph, a);
    b = livingPlane(graph, b);
  }
  std::erase_if(room.pairs, [&](const auto& pair) {
    return !pair.first.valid() || !pair.second.valid() || pair.first == pair.second ||
           graph.planes.at(pair.first).normal_map.dot(graph.planes.at(pair.second).normal_map) > kOpposed;
  });
}

bool RoomLayer::mergeDuplicates(std::vector<RoomObservation>& seen) {
  bool merged = false;
  std::map<RoomPair, int> twins;
  for (size_t j = 0; j < seen.size(); ++j) {
    if (one_of_.contains(seen[j].id)) continue;
    for (size_t i = 0; i < j; ++i) {
      if (one_of_.contains(seen[i].id)) continue;
      const auto matches = wallsOfSameRoom(seen[i], seen[j], builder_.graph().planes, config_.same_center_m);
      if (!matches) continue;
      const RoomPair pair{seen[i].id, seen[j].id};
      const auto before = twins_.find(pair);
      const int rounds = 1 + (before == twins_.end() ? 0 : before->second);
      if (rounds < kTwinRounds) {
        twins[pair] = rounds;
        continue;
      }
      mergeWalls(*matches);
      for (RoomObservation& room : seen) resolve(room);
      one_of_[pair.second] = pair.first;
      merged = true;
      break;
    }
  }
  twins_ = std::move(twins);
  return merged;
}

void RoomLayer::mergeWalls(const std::vector<std::pair<PlaneId, PlaneId>>& matches) {
  for (const auto& [a, b] : matches) {
    const auto& planes = builder_.graph().planes;
    if (a == b || !planes.contains(a) || !planes.contains(b)) continue;
    builder_.trust(a);
    builder_.trust(b);
    planes_.merge(std::max(a, b), std::min(a, b));
  }
}

// The later sight of a room stands back behind the earlier, and takes its place where that is gone.
void RoomLayer::absorb(std::vector<RoomObservation>& seen) {
  std::map<RoomId, const RoomObservation*> by_id;
  for (const RoomObservation& room : seen) by_id[room.id] = &room;
  std::set<RoomId> void_now;
  for (RoomObservation& room : seen) {
    const auto one = one_of_.find(room.id);
    if (one == one_of_.end()) continue;
    const auto earlier = by_id.find(one->second);
    if (earlier == by_id.end()) {
      room.id = one->second;
      by_id[room.id] = &room;
    } else if ((earlier->second->center_map - room.center_map).norm() <= config_.same_center_m) {
      void_now.insert(room.id);
    } else {
      one_of_.erase(one);  // they have parted
    }
  }
  std::erase_if(seen, [&](const RoomObservation& room) { return void_now.contains(room.id); });
  std::sort(seen.begin(), seen.end(), [](const auto& a, const auto& b) { return a.id < b.id; });
}

void RoomLayer::withdraw(const std::vector<RoomObservation>& seen) {
  std::set<RoomId> gone;
  for (const auto& [id, room] : builder_.graph().rooms) gone.insert(id);
  for (const RoomObservation& room : seen) gone.erase(room.id);
  for (const RoomId id : gone) builder_.removeRoom(id);
}

KeyframeId RoomLayer::anchorOf(const RoomObservation& room) const {
  const auto& keyframes = builder_.graph().keyframes;
  if (keyframes.contains(room.anchor)) return room.anchor;
  KeyframeId nearest;
  double least = std::numeric_limits<double>::infinity();
  for (const auto& [id, node] : keyframes) {
    const double distance = (node.T_map_body.translation.head<2>() - room.free_center_map).norm();
    if (node.floor != room.floor || distance >= least) continue;
    least = distance;
    nearest = id;
  }
  return nearest.valid() ? nearest : keyframes.begin()->first;
}

void RoomLayer::bind(const RoomObservation& room) {
  const CenterOf of{.room = room.id, .floor = {}};
  if (!config_.factors) return builder_.setCenter(of, room.center_map);
  const KeyframeId anchor = anchorOf(room);
  bindCenter({.of = of,
              .pairs = room.pairs,
              .finite = room.kind == RoomKind::kFinite,
              .center_map = room.kind == RoomKind::kInfinite ? room.free_center_map : room.center_map,
              .anchor = anchor,
              .height_m = builder_.graph().keyframes.at(anchor).T_map_body.translation.z(),
              .wall_sigma_m = config_.wall_sigma_m,
              .along_sigma_m = config_.along_sigma_m},
             builder_);
}

// Two walls are related once, whichever rooms they bound.
void RoomLayer::bindShapes() {
  if (!config_.factors) return;
  const SituationalGraph& graph = builder_.graph();
  headings_.update(graph);
  std::map<std::pair<PlaneId, PlaneId>, RoomShapeFactor> before;
  std::set<std::pair<PlaneId, PlaneId>> related;
  for (const RoomShapeFactor& f : graph.room_shapes) {
    before.emplace(std::minmax(f.a, f.b), f);
    related.insert(std::minmax(f.a, f.b));
  }
  std::map<std::pair<PlaneId, PlaneId>, RoomShapeFactor> wanted;
  for (const auto& [id, room] : graph.rooms)
    for (const WallRelation& r : wallRelations(room.seen, graph, headings_, config_.shape_sigma_rad, related))
      wanted.emplace(std::make_pair(r.a, r.b), RoomShapeFactor{0, id, r.a, r.b, r.square, r.sigma_rad});
  for (const auto& [walls, f] : before) {
    const auto now = wanted.find(walls);
    const bool stays = now != wanted.end() && now->second.room == f.room && now->second.square == f.square &&
                       now->second.sigma_rad == f.sigma_rad;
    if (stays)
      wanted.erase(now);
    else
      builder_.removeFactor(f.id);
  }
  for (const auto& [walls, f] : wanted) builder_.addRoomShape(f);
}

void RoomLayer::putDoorways(const std::vector<Doorway>& doorways) {
  const SituationalGraph& graph = builder_.graph();
  const auto known = [&](RoomId id) {
    if (const auto one = one_of_.find(id); one != one_of_.end() && !graph.rooms.contains(id))
      id = one->second;
    return graph.rooms.contains(id) ? id : RoomId{};
  };
  std::map<PassageId, Doorway> now;
  for (Doorway doorway : doorways) {
    doorway.a = known(doorway.a);
    doorway.b = known(doorway.b);
    if (!doorway.a.valid()) std::swap(doorway.a, doorway.b);
    const bool sound = doorway.id.valid() && doorway.position_map.norm() < kNoMapReaches_m &&
                       std::isfinite(doorway.width_m) && graph.floors.contains(doorway.floor);
    if (sound && doorway.a.valid() && doorway.a != doorway.b) now.emplace(doorway.id, doorway);
  }
  builder_.setDoorways(std::move(now));
}

}  // namespace sgraphs
