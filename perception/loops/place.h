#pragma once

#include <deque>
#include <map>
#include <vector>

#include "common/types/map_update.h"
#include "perception/loops/place_patches.h"
#include "perception/loops/sight.h"
#include "perception/loops/walked_path.h"

namespace sgraphs {

// What is kept of a keyframe's cloud.
struct Place {
  explicit Place(const Keyframe& keyframe);

  KeyframeId id;
  std::vector<PackedPatch> patches;  // in body
  Sight sight;

  size_t bytes() const;
};

// A place and its body's pose in some common frame.
struct PlacedPlace {
  const Place* place = nullptr;
  SE3 T_frame_body;
};

// From a pose to the old place that stands for it.
inline constexpr double kAnchorReach_m = 3.0;

// Of things with a T_map_body the one nearest to a position from above, closer than `within_m`; nullptr:
// none.
template <typename Placed>
const Placed* nearestFromAbove(const std::vector<Placed>& things, const Eigen::Vector2d& position_map,
                               double within_m) {
  const Placed* best = nullptr;
  for (const Placed& thing : things) {
    const double d_m = (thing.T_map_body.translation.template head<2>() - position_map).norm();
    if (d_m >= within_m) continue;
    within_m = d_m;
    best = &thing;
  }
  return best;
}

// Remembered places, with their poses in the present map. One per `place_spacing_m` of explored space: what
// is seen again from where it was seen before is forgotten once it lies off the newest path, so that memory
// grows with the building and not with the time spent in it.
class PlaceMemory {
 public:
  PlaceMemory(double spacing_m, double newest_path_m)
      : spacing_m_(spacing_m), newest_path_m_(newest_path_m) {}

  void apply(const MapUpdate& update);
  // The newest keyframe; `path` holds it already.
  void add(const Keyframe& keyframe, const WalkedPath& path);

  bool known(KeyframeId id) const { return map_.contains(id); }
  const MapKeyframe& poseOf(KeyframeId id) const { return map_.at(id); }
  const Place* find(KeyframeId id) const;

  // By id; poses in map.
  const std::map<KeyframeId, Place>& places() const { return places_; }
  // Places along the path's last metres before `id`, that one first; none from before a ride.
  std::vector<const Place*> newestBefore(KeyframeId id, double path_m, const WalkedPath& path) const;

  size_t bytes() const;

 private:
  bool redundant(KeyframeId id, const WalkedPath& path) const;

  double spacing_m_;
  double newest_path_m_;
  std::map<KeyframeId, MapKeyframe> map_;
  std::map<KeyframeId, Place> places_;
  std::deque<KeyframeId> newest_;  // not judged yet
};

}  // namespace sgraphs
