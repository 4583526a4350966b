#pragma once

#include <map>
#include <vector>

#include "common/types/map_update.h"
#include "common/types/rooms.h"

namespace sgraphs {

struct StoreyConfig {
  double climb_slope = 0.15;   // rise over distance that a robot climbs with
  double same_storey_m = 1.0;  // walking surfaces this close in height are one storey
};

// Which storey each keyframe stands on, from the heights along the path: a climb ends where the robot has
// walked level again, on a storey that is known at this height, or on a new one. Stairs and ramps are climbs.
// A robot that is carried to another height, between two sessions or in a lift, is on the storey of that
// height. Storeys that turn out to lie at one height were one: the older stays.
class StoreyTracker {
 public:
  explicit StoreyTracker(const StoreyConfig& config) : config_(config) {}

  // Keyframes of the map as they lie now; returns those whose storey is new or another, by id.
  std::vector<KeyframeFloor> step(const std::map<KeyframeId, MapKeyframe>& keyframes);

  // Invalid: between storeys, or unknown.
  FloorId floorOf(KeyframeId keyframe) const;
  // Median height of the body on each storey [m].
  const std::map<FloorId, double>& bodyHeights() const { return heights_; }

 private:
  struct Step {
    KeyframeId id;
    double path_m;  // walked until here, seen from above
    double z_m;
  };
  void add(const MapKeyframe& keyframe);
  void onStorey();
  void onClimb();
  void onCarried();
  void arrive(FloorId floor, size_t first);
  double slope(size_t first) const;
  size_t firstWithin(double path_m) const;
  FloorId nearestTo(double z_m) const;
  void uniteStoreys();
  void assign(KeyframeId keyframe, FloorId floor);
  void measureHeights(const std::map<KeyframeId, MapKeyframe>& keyframes);

  StoreyConfig config_;
  std::vector<Step> steps_;
  FloorId current_;  // the storey the robot is on, or left last
  bool climbing_ = false;
  size_t climb_begin_ = 0;  // first step of the climb
  double arrival_m_ = 0;    // walked level, ends this climb
  size_t arrived_ = 0;      // first step after the last climb
  std::map<KeyframeId, FloorId> floors_;
  std::map<KeyframeId, FloorId> changed_;
  std::map<FloorId, double> heights_;
  int64_t next_floor_ = 0;
};

}  // namespace sgraphs
