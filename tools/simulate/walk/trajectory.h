#pragma once

#include <cstddef>
#include <functional>
#include <utility>
#include <vector>

#include "common/base/time.h"
#include "common/geometry/se3.h"

namespace sgraphs::simulate {

// Up or down in a lift, in seconds after the trajectory's start. The body stands while its door closes, while
// the car moves, and while the door opens.
struct Ride {
  size_t lift = 0;              // index in the scene
  double from_m = 0, to_m = 0;  // height over the path's floor of the walking surface before and after
  double door_closes_s = 0, leaves_s = 0, arrives_s = 0, door_opens_s = 0;

  double middle_s() const { return 0.5 * (leaves_s + arrives_s); }
};

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

  SE3 poseAt(Time time) const { return poseAtOffset((time - start_).seconds()); }
  // For instants between whole microseconds, as the lasers' firings are.
  SE3 poseAtOffset(double seconds) const;

  // The function that was given says where the body is but for these rides: they raise or lower what follows.
  void setRides(std::vector<Ride> rides) { rides_ = std::move(rides); }
  const std::vector<Ride>& rides() const { return rides_; }
  // What legs feel: no rides.
  SE3 feltPoseAt(Time time) const { return T_building_body_((time - start_).seconds()); }
  // From where the building is seen. In the closed car the walls of one floor look like those of the other:
  // the body goes from one to the other half-way in no time.
  SE3 seenPoseAtOffset(double seconds) const;

 private:
  Time start_;
  Duration duration_;
  Function T_building_body_;
  std::vector<Ride> rides_;  // in order of time
};

}  // namespace sgraphs::simulate
