#pragma once

#include <Eigen/Core>
#include <vector>

#include "tools/simulate/walk/trajectory.h"

namespace sgraphs::simulate {

struct Waypoint {
  Eigen::Vector2d xy = Eigen::Vector2d::Zero();  // in the building [m]
  double pause_s = 0;                            // standing here; the turn follows on the spot
  // Height of the walking surface here above the path's floor [m]. Between waypoints it rises evenly with the
  // distance walked: stairs and ramps begin and end at waypoints. The body pitches along, as the ground under
  // its feet does, 0.3 m before and behind its middle.
  double rise_m = 0;
  // What lifts have raised the body by until here; rise_m is without.
  double ridden_m = 0;
  // Here the body rides in this lift of the scene, after the pause: by ride_m, upwards if positive.
  int lift = -1;
  double ride_m = 0;
};

// A lift's door takes kDoor_s to close and to open; the car moves at kRide_mps, and to start and to stop it
// takes kRideStart_s more, all together.
inline constexpr double kDoor_s = 2.0;
inline constexpr double kRide_mps = 1.0;
inline constexpr double kRideStart_s = 2.5;

// Sway of a walking quadruped; it fades in and out with the motion.
struct Gait {
  double bob_m = 0.01;
  double bob_hz = 4.0;
  double roll_rad = 0.0174533;
  double roll_hz = 1.0;
  double pitch_rad = 0.00872665;
  double pitch_hz = 2.0;
};

// A walk along waypoints: straight legs, arcs at the corners, turns on the spot where a corner is too sharp.
struct WalkPath {
  std::vector<Waypoint> waypoints;
  double start_heading_rad = 0;
  double start_pause_s = 3;
  double end_pause_s = 2;
  double speed_mps = 0.8;
  double acceleration_mps2 = 0.6;  // along the path
  double yaw_rate_rad_s = 0.8;     // arcs are walked as slowly as it asks for
  double yaw_acceleration_rad_s2 = 1.6;
  double turn_radius_m = 0.6;  // of arcs, where the legs are long enough
  double body_height_m = 0.52;
  double clearance_m = 0.3;  // between the middle of the body and any wall or box
  Gait gait;
};

// Bounds that a walk keeps (the gait's sway aside): speed and yaw rate as in WalkPath; the acceleration is
// that along the path and, in arcs, speed times yaw rate across it.
//
// The motion is a uniform cubic B-spline in x, y, yaw, strength of the gait, rise and slope, whose control
// points sample a walk with bounded acceleration every kKnot_s. It is twice continuously differentiable, and,
// as each derivative of the spline is a convex combination of differences of control points, the bounds of
// the sampled walk hold for it too.
inline constexpr double kKnot_s = 0.25;

// `floor_z_m`: height of the path's floor. The path needs at least one waypoint; consecutive ones differ.
Trajectory walkAlong(const WalkPath& path, Time start, double floor_z_m);

}  // namespace sgraphs::simulate
