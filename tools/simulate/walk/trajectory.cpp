#include "tools/simulate/walk/trajectory.h"

#include <utility>

namespace sgraphs::simulate {

Trajectory::Trajectory(Time start, Duration duration, Function T_building_body)
    : start_(start), duration_(duration), T_building_body_(std::move(T_building_body)) {}

Trajectory Trajectory::still(Time start, Duration duration, const SE3& T_building_body) {
  return {start, duration, [T_building_body](double) { return T_building_body; }};
}

Trajectory Trajectory::constantTwist(Time start, Duration duration, const SE3& T_start,
                                     const Vector6d& twist_body) {
  return {start, duration,
          [T_start, twist_body](double seconds) { return T_start * se3Exp(seconds * twist_body); }};
}

}  // namespace sgraphs::simulate
