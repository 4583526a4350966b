#include "perception/rooms/room_tracker.h"

#include <algorithm>
#include <cmath>
#include <set>

namespace sgraphs {
namespace {

constexpr double kSameRoom = 0.5;  // shared area by the smaller one's
constexpr double kSameArea = 0.1;  // relative change of area of a room that looks alike

}  // namespace

bool RoomTracker::isStable(const RoomCandidate& candidate) {
  Sight& sight = sights_[candidate.cluster];
  std::vector<PlaneId> walls = candidate.shape->walls();
  const double area_m2 = candidate.shape->area_m2;
  const bool alike = sight.rounds > 0 && walls == sight.walls &&
                     std::abs(area_m2 - sight.area_m2) <= kSameArea * sight.area_m2;
  sight = {std::move(walls), area_m2, alike ? sight.rounds + 1 : 1};
  return sight.rounds >= config_.stable_rounds;
}

// Each room and the candidate it is: of those that share most of the smaller one's area, the one that shares
// most. When a room fell apart, that is its larger part.
std::map<RoomId, size_t> RoomTracker::matches(const std::vector<RoomCandidate>& candidates) const {
  std::map<RoomId, size_t> result;
  for (const auto& [id, room] : rooms_) {
    double most = 0;
    for (size_t i = 0; i < candidates.size(); ++i) {
      if (candidates[i].floor != room.floor) continue;
      const double shared = sharedArea(room.shape.polygon, candidates[i].shape->polygon);
      if (shared < kSameRoom * std::min(room.shape.area_m2, candidates[i].shape->area_m2)) continue;
      if (shared <= most) continue;
      most = shared;
      result[id] = i;
    }
  }
  return result;
}

void RoomTracker::step(Time time, const std::vector<RoomCandidate>& candidates,
                       const std::vector<ClusterId>& kept) {
  std::vector<bool> stable(candidates.size());
  std::map<ClusterId, Sight> sights;
  for (size_t i = 0; i < candidates.size(); ++i) {
    stable[i] = isStable(candidates[i]);
    sights[candidates[i].cluster] = sights_[candidates[i].cluster];
  }
  sights_ = std::move(sights);

  std::vector<bool> taken(candidates.size(), false);
  const std::map<RoomId, size_t> matched = matches(candidates);
  for (auto it = rooms_.begin(); it != rooms_.end();) {
    TrackedRoom& room = it->second;
    const auto match = matched.find(room.id);
    bool gone = false;
    if (match == matched.end()) {
      const bool keep = std::find(kept.begin(), kept.end(), room.cluster) != kept.end();
      gone = !keep && ++room.missed_rounds >= config_.patience_rounds;
    } else if (taken[match->second]) {
      gone = stable[match->second];  // it has become one with a room of a lower id
    } else {
      const RoomCandidate& candidate = candidates[match->second];
      taken[match->second] = true;
      room.missed_rounds = 0;
      room.cluster = candidate.cluster;
      if (stable[match->second]) room.shape = *candidate.shape;
    }
    it = gone ? rooms_.erase(it) : std::next(it);
  }
  for (size_t i = 0; i < candidates.size(); ++i) {
    if (taken[i] || !stable[i] || !candidates[i].entered) continue;
    const RoomId id{next_id_++};
    rooms_[id] = {id, candidates[i].cluster, candidates[i].floor, time, *candidates[i].shape, 0, {}};
  }
  dropOverlapped();
}

// A room that nothing supports any more gives way to one in its place.
void RoomTracker::dropOverlapped() {
  std::set<RoomId> dropped;
  for (const auto& [id, old] : rooms_) {
    if (old.missed_rounds == 0) continue;
    for (const auto& [other_id, other] : rooms_) {
      if (other.missed_rounds > 0 || other.floor != old.floor) continue;
      const double shared = sharedArea(old.shape.polygon, other.shape.polygon);
      if (shared > kSameRoom * std::min(old.shape.area_m2, other.shape.area_m2)) dropped.insert(id);
    }
  }
  for (const RoomId& id : dropped) rooms_.erase(id);
}

RoomId RoomTracker::roomOf(ClusterId cluster) const {
  for (const auto& [id, room] : rooms_)
    if (room.cluster == cluster) return id;
  return {};
}

}  // namespace sgraphs
