#include "perception/loops/floor_return.h"

#include <algorithm>
#include <set>

namespace sgraphs {
namespace {

constexpr size_t kAgreeing = 4;
constexpr size_t kMostKept = 40;  // of the newest, where a likeness is never decided
constexpr double kOver_m = 10.0;  // of path between the first and the last of them
constexpr int kContradicted = 2;  // looks that cannot be of a floor
constexpr double kDrift_m = 0.5;  // of the path since the ride, sideways

}  // namespace

bool FloorReturn::recognised(FloorId floor, const WalkedPath& path) const {
  const Evidence& evidence = others_.at(floor);
  if (floor == left_ || evidence.refuted > 0 || evidence.agreeing.size() < kAgreeing) return false;
  const double over_m =
      path.walkedTo(evidence.agreeing.back().loop.to) - path.walkedTo(evidence.agreeing.front().loop.to);
  return over_m >= kOver_m && std::all_of(others_.begin(), others_.end(), [&](const auto& other) {
           return other.first == floor || other.second.refuted >= kContradicted;
         });
}

std::vector<LoopHypothesis> FloorReturn::step(KeyframeId keyframe, const PlaceMemory& memory,
                                              const WalkedPath& path) {
  const FloorId floor = memory.poseOf(keyframe).floor;
  if (!floor.valid()) return {};
  if (path.ridesBefore(keyframe) > ride_) {
    ride_ = path.ridesBefore(keyframe);
    own_ = floor;
    left_ = latest_;
    joined_ = false;
    others_.clear();
  }
  latest_ = floor;
  // Stairs have led on: which floor that is follows from where they began.
  if (joined_ || floor != own_) return {};
  std::set<FloorId> floors;
  for (const auto& [id, place] : memory.places())
    if (memory.known(id) && path.ridesBefore(id) < ride_) floors.insert(memory.poseOf(id).floor);
  floors.erase(FloorId{});
  floors.erase(own_);
  for (const FloorId other : floors) {
    Evidence& evidence = others_[other];
    if (evidence.refuted >= kContradicted) continue;
    const auto h = search_.straightAcross(keyframe, other, memory, path);
    if (!h) continue;
    if (h->check.refuted(config_.verification)) ++evidence.refuted;
    if (h->check.alike(config_.verification) && h->check.fixed(config_.verification) &&
        h->correction_m < kDrift_m &&
        (evidence.agreeing.empty() ||
         path.walkedTo(keyframe) - path.walkedTo(evidence.agreeing.back().loop.to) >=
             0.5 * config_.spacing_m))
      evidence.agreeing.push_back(*h);
    if (evidence.agreeing.size() > kMostKept) evidence.agreeing.erase(evidence.agreeing.begin());
  }
  for (const auto& [other, evidence] : others_) {
    if (!recognised(other, path)) continue;
    joined_ = true;
    return evidence.agreeing;
  }
  return {};
}

}  // namespace sgraphs
