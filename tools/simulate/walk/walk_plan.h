#pragma once

#include <functional>
#include <utility>
#include <vector>

#include "tools/simulate/walk/walk.h"

namespace sgraphs::simulate {

// State of the planned walk, before smoothing.
struct WalkState {
  Eigen::Vector2d xy = Eigen::Vector2d::Zero();
  double yaw_rad = 0;   // continuous: not wrapped
  double activity = 0;  // 0 standing, 1 walking or turning in earnest
  double walked_m = 0;  // since the start, seen from above
  double rise_m = 0;    // of the walking surface over the path's floor
  double slope = 0;     // of the body along its way: rise per distance
};

// Height of the walking surface over the distance walked: straight between knots.
class RiseProfile {
 public:
  // Knots come in order of the distance; one that repeats the distance before is left out.
  void add(double walked_m, double rise_m);
  double at(double walked_m) const;
  // Mean slope between the hind feet and the fore feet of a body that stands here. It has no jumps.
  double slope(double walked_m) const;

 private:
  std::vector<std::pair<double, double>> knots_;
};

// The walk as phases: standing, turning on the spot, runs of legs and arcs. Position and speed along the way
// are continuous, as are yaw, rise and slope.
class WalkPlan {
 public:
  explicit WalkPlan(const WalkPath& path);

  double duration() const { return duration_s_; }
  const std::vector<Ride>& rides() const { return rides_; }
  // States before the start and after the end are the first and the last.
  WalkState at(double seconds) const;

 private:
  struct Phase {
    double begin_s;
    double duration_s;
    std::function<WalkState(double)> state;  // of the seconds since begin_s
  };

  void stand(double seconds);
  void ride(const Waypoint& waypoint);
  void turn(double angle_rad);
  // Walks from waypoint `first` to waypoint `last` with arcs at the corners between.
  void run(size_t first, size_t last);
  bool stopsAt(size_t waypoint) const;
  double cornerRadius(size_t waypoint) const;
  void append(double duration_s, std::function<WalkState(double)> state);

  WalkPath path_;
  RiseProfile rise_;
  std::vector<Phase> phases_;
  std::vector<Ride> rides_;
  double duration_s_ = 0;
  WalkState now_;  // at the end of the last phase
};

}  // namespace sgraphs::simulate
