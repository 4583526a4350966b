#pragma once

#include <functional>

#include "common/base/time.h"
#include "common/geometry/se3.h"

namespace sgraphs::simulate {

// Where the body is at any instant, exactly: a function of time, not a list of samples.
class Trajectory {
 public:
  // T_building_body at a number of seconds after the start; must be safe to call from several threads.
  using Function = std::function<SE3(double seconds)>;

  Trajectory(Time start, Duration duration, Function T_building_body);

  // The body does not move.
  static Trajectory still(Time start, Duration duration, const SE3& T_building_body);
  // T_building_body(t) = T_start * exp(t * twist_body); twist in body: [m/s], [rad/s].
  static Trajectory constantTwist(Time start, Duration duration, const SE3& T_start,
                                  const Vector6d& twist_body);

  Time start() const { return start_; }
  Time end() const { return start_ + duration_; }
  Duration duration() const { return duration_; }

  SE3 poseAt(Time time) const { return T_building_body_((time - start_).seconds()); }
  // For instants between whole microseconds, as the lasers' firings are.
  SE3 poseAtOffset(double seconds) const { return T_building_body_(seconds); }

 private:
  Time start_;
  Duration duration_;
  Function T_building_body_;
};

}  // namespace sgraphs::simulate
