#include "tools/simulate/walk/walk.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

#include "tools/simulate/walk/walk_plan.h"

namespace sgraphs::simulate {
namespace {

// The walk's degrees of freedom: x, y, yaw, strength of the gait, rise of the walking surface, slope.
using State = Eigen::Matrix<double, 6, 1>;

// Uniform cubic B-spline through them.
class Spline {
 public:
  explicit Spline(const WalkPlan& plan) {
    const int knots = static_cast<int>(std::ceil(plan.duration() / kKnot_s)) + 3;
    for (int k = -1; k <= knots; ++k) {
      const WalkState state = plan.at(k * kKnot_s);
      State control;
      control << state.xy, state.yaw_rad, state.activity, state.rise_m, state.slope;
      controls_.push_back(control);
    }
  }

  State at(double seconds) const {
    const double last = static_cast<double>(controls_.size()) - 3.0;
    const double position = std::clamp(seconds / kKnot_s, 0.0, last);
    const double whole = std::min(std::floor(position), last - 1.0);
    const double u = position - whole, v = 1.0 - u;
    const State* c = &controls_[static_cast<size_t>(whole)];
    return (v * v * v * c[0] + (3 * u * u * u - 6 * u * u + 4) * c[1] +
            (3 * v * v * v - 6 * v * v + 4) * c[2] + u * u * u * c[3]) /
           6.0;
  }

 private:
  std::vector<State> controls_;  // controls_[k] stands at (k - 1) * kKnot_s
};

// The body's x axis lies along the slope; the gait sways about that.
SE3 bodyPose(const State& state, double height_m, const Gait& gait, double seconds) {
  const double phase = 2 * std::numbers::pi * seconds, strength = state[3];
  const double roll = strength * gait.roll_rad * std::sin(gait.roll_hz * phase);
  const double sway = strength * gait.pitch_rad * std::sin(gait.pitch_hz * phase);
  const double pitch = sway - std::atan(state[5]);
  const double bob = strength * gait.bob_m * std::sin(gait.bob_hz * phase);
  const Eigen::Quaterniond yaw(std::cos(0.5 * state[2]), 0, 0, std::sin(0.5 * state[2]));
  const Eigen::Quaterniond tilt_y(std::cos(0.5 * pitch), 0, std::sin(0.5 * pitch), 0);
  const Eigen::Quaterniond tilt_x(std::cos(0.5 * roll), std::sin(0.5 * roll), 0, 0);
  return {yaw * tilt_y * tilt_x, {state[0], state[1], height_m + state[4] + bob}};
}

}  // namespace

Trajectory walkAlong(const WalkPath& path, Time start, double floor_z_m) {
  const WalkPlan plan(path);
  const auto spline = std::make_shared<const Spline>(plan);
  const double height_m = floor_z_m + path.body_height_m;
  Trajectory trajectory(start, Duration::fromSeconds(plan.duration()),
                        [spline, height_m, gait = path.gait](double seconds) {
                          return bodyPose(spline->at(seconds), height_m, gait, seconds);
                        });
  trajectory.setRides(plan.rides());
  return trajectory;
}

}  // namespace sgraphs::simulate
