#include "perception/loops/place.h"

namespace sgraphs {
namespace {

constexpr size_t kMaxUpright = 380;
constexpr size_t kMaxLevel = 120;
// Two places whose relative pose is less known than this are not known to be one.
constexpr double kOnePlace_m = 1.5;
constexpr double kNeighbour_m = 6.0;

std::vector<PackedPatch> packed(const Keyframe& keyframe) {
  const std::vector<Surfel> patches = patchesOf(keyframe, kMaxUpright, kMaxLevel);
  std::vector<PackedPatch> out;
  out.reserve(patches.size());
  for (const Surfel& s : patches) out.emplace_back(s);
  return out;
}

}  // namespace

Place::Place(const Keyframe& keyframe) : id(keyframe.id), patches(packed(keyframe)), sight(keyframe) {}

size_t Place::bytes() const {
  return sizeof(Place) + patches.capacity() * sizeof(PackedPatch) + sight.bytes();
}

void PlaceMemory::apply(const MapUpdate& update) {
  for (const MapKeyframe& k : update.keyframes) map_[k.id] = k;
}

const Place* PlaceMemory::find(KeyframeId id) const {
  const auto it = places_.find(id);
  return it == places_.end() ? nullptr : &it->second;
}

bool PlaceMemory::redundant(KeyframeId id, const WalkedPath& path) const {
  const auto here = map_.find(id);
  if (here == map_.end()) return true;
  const WalkedPath::Gates gates = path.gatesFrom(id);
  for (const auto& [other_id, place] : places_) {
    if (other_id >= id) break;
    const auto other = map_.find(other_id);
    if (other == map_.end() || other->second.floor != here->second.floor) continue;
    const double apart = (other->second.T_map_body.translation - here->second.T_map_body.translation).norm();
    if (apart > spacing_m_) continue;
    if (path.walkedTo(id) - path.walkedTo(other_id) < kNeighbour_m ||
        gates.at(other_id).radius_m < kOnePlace_m)
      return true;
  }
  return false;
}

void PlaceMemory::add(const Keyframe& keyframe, const WalkedPath& path) {
  places_.emplace(keyframe.id, Place(keyframe));
  newest_.push_back(keyframe.id);
  while (path.walkedTo(keyframe.id) - path.walkedTo(newest_.front()) > newest_path_m_) {
    if (redundant(newest_.front(), path)) places_.erase(newest_.front());
    newest_.pop_front();
  }
}

std::vector<const Place*> PlaceMemory::newestBefore(KeyframeId id, double path_m,
                                                    const WalkedPath& path) const {
  std::vector<const Place*> out;
  for (auto it = places_.upper_bound(id); it != places_.begin();) {
    --it;
    if (path.walkedTo(id) - path.walkedTo(it->first) > path_m) break;
    if (path.ridesBefore(it->first) != path.ridesBefore(id)) break;
    out.push_back(&it->second);
  }
  return out;
}

size_t PlaceMemory::bytes() const {
  size_t sum = 0;
  for (const auto& [id, place] : places_) sum += place.bytes();
  return sum;
}

}  // namespace sgraphs
