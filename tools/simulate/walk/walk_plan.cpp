#include "tools/simulate/walk/walk_plan.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <utility>

namespace sgraphs::simulate {
namespace {

constexpr double kStep_m = 0.01;             // grid of the speed profile
constexpr double kFarthestMiss_m = 0.25;     // of a waypoint, by the arc that rounds it
constexpr double kSmallestRadius_m = 0.2;    // narrower arcs are turned on the spot
constexpr double kHalfBody_m = 0.3;          // from the body's origin to the fore feet, and to the hind feet
constexpr double kFullActivity_mps = 0.3;    // speed of full gait
constexpr double kFullActivity_radps = 0.3;  // yaw rate of full gait

double wrap(double angle) {
  return std::remainder(angle, 2 * std::numbers::pi);
}

double headingOf(const Eigen::Vector2d& v) {
  return std::atan2(v.y(), v.x());
}

double activityOf(double speed, double yaw_rate) {
  return std::min(1.0, std::max(speed / kFullActivity_mps, std::abs(yaw_rate) / kFullActivity_radps));
}

// Stretch of constant curvature.
struct Element {
  double begin_m = 0;
  double length_m = 0;
  Eigen::Vector2d xy = Eigen::Vector2d::Zero();  // at its beginning
  double yaw_rad = 0;
  double curvature = 0;  // [1/m], positive to the left
  double slope = 0;      // rise per distance walked
};

// Elements with a speed profile: from rest to rest with bounded speed, acceleration and yaw rate.
class Run {
 public:
  void add(Element element) {
    element.begin_m = length();
    if (element.length_m > 1e-9) elements_.push_back(element);
  }

  double length() const {
    return elements_.empty() ? 0 : elements_.back().begin_m + elements_.back().length_m;
  }

  void plan(const WalkPath& path) {
    const int cells = std::max(4, static_cast<int>(std::ceil(length() / kStep_m)));
    step_m_ = length() / cells;
    speed_.assign(static_cast<size_t>(cells) + 1, path.speed_mps);
    for (const Element& e : elements_) {
      if (e.curvature == 0 && e.slope == 0) continue;
      const auto first = static_cast<size_t>(e.begin_m / step_m_);
      const auto last = static_cast<size_t>(std::ceil((e.begin_m + e.length_m) / step_m_));
      for (size_t i = first; i <= std::min(last, speed_.size() - 1); ++i)
        speed_[i] = std::min(speed_[i], fastest(e, path));
    }
    speed_.front() = speed_.back() = 0;
    const double gain = 2 * path.acceleration_mps2 * step_m_;
    for (size_t i = 1; i < speed_.size(); ++i)
      speed_[i] = std::min(speed_[i], std::sqrt(speed_[i - 1] * speed_[i - 1] + gain));
    for (size_t i = speed_.size() - 1; i-- > 0;)
      speed_[i] = std::min(speed_[i], std::sqrt(speed_[i + 1] * speed_[i + 1] + gain));
    time_.assign(1, 0.0);
    for (size_t i = 1; i < speed_.size(); ++i)
      time_.push_back(time_.back() + 2 * step_m_ / (speed_[i - 1] + speed_[i]));
  }

  double duration() const { return time_.back(); }

  WalkState at(double seconds) const {
    const auto next = std::upper_bound(time_.begin() + 1, time_.end() - 1, seconds);
    const auto i = static_cast<size_t>(next - time_.begin()) - 1;
    const double tau = std::clamp(seconds - time_[i], 0.0, time_[i + 1] - time_[i]);
    const double acceleration = (speed_[i + 1] - speed_[i]) / (time_[i + 1] - time_[i]);
    const double s = static_cast<double>(i) * step_m_ + speed_[i] * tau + 0.5 * acceleration * tau * tau;
    return stateAt(s, speed_[i] + acceleration * tau);
  }

 private:
  // Speed seen from above: the path's speed holds along the slope.
  static double fastest(const Element& e, const WalkPath& path) {
    const double along = path.speed_mps / std::hypot(1.0, e.slope);
    return e.curvature == 0 ? along : std::min(along, path.yaw_rate_rad_s / std::abs(e.curvature));
  }

  WalkState stateAt(double s, double speed) const {
    size_t k = 0;
    while (k + 1 < elements_.size() && elements_[k + 1].begin_m <= s) ++k;
    const Element& e = elements_[k];
    const double along = std::min(s - e.begin_m, e.length_m), turned = e.curvature * along;
    WalkState state;
    state.walked_m = e.begin_m + along;
    state.yaw_rad = e.yaw_rad + turned;
    // Chord of the arc, in the direction half-way between the tangents.
    const double chord = std::abs(turned) < 1e-9 ? along : 2 * std::sin(0.5 * turned) / e.curvature;
    const double direction = e.yaw_rad + 0.5 * turned;
    state.xy = e.xy + chord * Eigen::Vector2d(std::cos(direction), std::sin(direction));
    state.activity = activityOf(speed, speed * e.curvature);
    return state;
  }

  std::vector<Element> elements_;
  double step_m_ = 0;
  std::vector<double> speed_;  // at the grid's points [m/s]
  std::vector<double> time_;   // when the grid's points are reached [s]
};

}  // namespace

void RiseProfile::add(double walked_m, double rise_m) {
  if (knots_.empty() || walked_m > knots_.back().first) knots_.emplace_back(walked_m, rise_m);
}

double RiseProfile::at(double walked_m) const {
  const auto next =
      std::find_if(knots_.begin(), knots_.end(), [&](const auto& knot) { return knot.first > walked_m; });
  if (next == knots_.begin()) return knots_.front().second;
  if (next == knots_.end()) return knots_.back().second;
  const auto& [s0, rise0] = *(next - 1);
  const auto& [s1, rise1] = *next;
  return rise0 + (rise1 - rise0) * (walked_m - s0) / (s1 - s0);
}

double RiseProfile::slope(double walked_m) const {
  return (at(walked_m + kHalfBody_m) - at(walked_m - kHalfBody_m)) / (2 * kHalfBody_m);
}

WalkPlan::WalkPlan(const WalkPath& path) : path_(path) {
  const auto& points = path_.waypoints;
  now_.xy = points.front().xy;
  now_.yaw_rad = path_.start_heading_rad;
  rise_.add(0, points.front().rise_m);
  stand(path_.start_pause_s + points.front().pause_s);
  for (size_t first = 0; first + 1 < points.size();) {
    size_t last = first + 1;
    while (last + 1 < points.size() && !stopsAt(last)) ++last;
    turn(wrap(headingOf(points[first + 1].xy - points[first].xy) - now_.yaw_rad));
    run(first, last);
    stand(points[last].pause_s);
    ride(points[last]);
    first = last;
  }
  stand(path_.end_pause_s);
}

WalkState WalkPlan::at(double seconds) const {
  WalkState state = now_;
  if (!phases_.empty()) {
    const double t = std::clamp(seconds, 0.0, duration_s_);
    size_t k = 0;
    while (k + 1 < phases_.size() && phases_[k + 1].begin_s <= t) ++k;
    state = phases_[k].state(t - phases_[k].begin_s);
  }
  state.rise_m = rise_.at(state.walked_m);
  state.slope = rise_.slope(state.walked_m);
  return state;
}

void WalkPlan::append(double duration_s, std::function<WalkState(double)> state) {
  if (duration_s <= 0) return;
  now_ = state(duration_s);
  now_.activity = 0;
  phases_.push_back({duration_s_, duration_s, std::move(state)});
  duration_s_ += duration_s;
}

void WalkPlan::stand(double seconds) {
  append(seconds, [state = now_](double) { return state; });
}

void WalkPlan::ride(const Waypoint& waypoint) {
  if (waypoint.lift < 0) return;
  Ride ride;
  ride.lift = static_cast<size_t>(waypoint.lift);
  ride.from_m = waypoint.rise_m + waypoint.ridden_m;
  ride.to_m = ride.from_m + waypoint.ride_m;
  ride.door_closes_s = duration_s_;
  ride.leaves_s = ride.door_closes_s + kDoor_s;
  ride.arrives_s = ride.leaves_s + std::abs(waypoint.ride_m) / kRide_mps + kRideStart_s;
  ride.door_opens_s = ride.arrives_s + kDoor_s;
  stand(ride.door_opens_s - ride.door_closes_s);
  rides_.push_back(ride);
}

void WalkPlan::turn(double angle_rad) {
  if (std::abs(angle_rad) < 1e-6) return;
  // Trapezoid of the yaw rate, or a triangle if the turn is short.
  const double acceleration = path_.yaw_acceleration_rad_s2, angle = std::abs(angle_rad);
  const double rate = std::min(path_.yaw_rate_rad_s, std::sqrt(angle * acceleration));
  const double ramp_s = rate / acceleration, total_s = angle / rate + ramp_s;
  append(total_s, [=, start = now_, sign = angle_rad > 0 ? 1.0 : -1.0](double t) {
    const double left_s = total_s - t;
    double turned = rate * (t - 0.5 * ramp_s), speed = rate;
    if (t < ramp_s) {
      turned = 0.5 * acceleration * t * t;
      speed = acceleration * t;
    } else if (left_s < ramp_s) {
      turned = angle - 0.5 * acceleration * left_s * left_s;
      speed = acceleration * left_s;
    }
    WalkState state = start;
    state.yaw_rad += sign * turned;
    state.activity = activityOf(0, speed);
    return state;
  });
}

double WalkPlan::cornerRadius(size_t waypoint) const {
  const auto& points = path_.waypoints;
  const Eigen::Vector2d in = points[waypoint].xy - points[waypoint - 1].xy;
  const Eigen::Vector2d out = points[waypoint + 1].xy - points[waypoint].xy;
  const double half = 0.5 * std::abs(wrap(headingOf(out) - headingOf(in)));
  if (half < 1e-9) return path_.turn_radius_m;
  // Each leg gives half of its length to the arc; the arc passes the corner at radius * (1 / cos(half) - 1).
  const double by_length = 0.5 * std::min(in.norm(), out.norm()) / std::tan(half);
  const double by_miss = kFarthestMiss_m * std::cos(half) / (1.0 - std::cos(half));
  return std::min({path_.turn_radius_m, by_length, by_miss});
}

bool WalkPlan::stopsAt(size_t waypoint) const {
  return path_.waypoints[waypoint].pause_s > 0 || path_.waypoints[waypoint].lift >= 0 ||
         cornerRadius(waypoint) < kSmallestRadius_m;
}

void WalkPlan::run(size_t first, size_t last) {
  const auto& points = path_.waypoints;
  auto course = std::make_shared<Run>();
  WalkState at = now_;
  double leg_begin_m = 0;  // along the course: the middle of the arc at the leg's first waypoint
  for (size_t i = first; i < last; ++i) {
    const Eigen::Vector2d leg = points[i + 1].xy - at.xy;
    const bool corner = i + 1 < last;
    const double heading = headingOf(points[i + 1].xy - points[i].xy);
    const double angle = corner ? wrap(headingOf(points[i + 2].xy - points[i + 1].xy) - heading) : 0.0;
    const bool arc = std::abs(angle) >= 1e-9;
    const double radius = corner ? cornerRadius(i + 1) : 0.0;
    const double tangent = radius * std::tan(0.5 * std::abs(angle));
    const double straight = std::max(0.0, leg.norm() - tangent);
    const double half_arc = arc ? 0.5 * radius * std::abs(angle) : 0.0;
    const double leg_end_m = course->length() + straight + half_arc;
    const double slope = (points[i + 1].rise_m - points[i].rise_m) / (leg_end_m - leg_begin_m);
    const Eigen::Vector2d forward(std::cos(heading), std::sin(heading));
    course->add({0, straight, at.xy, at.yaw_rad, 0, slope});
    at.xy += straight * forward;
    rise_.add(now_.walked_m + leg_end_m, points[i + 1].rise_m);
    leg_begin_m = leg_end_m;
    if (!arc) continue;
    const double sign = angle > 0 ? 1.0 : -1.0;
    course->add({0, 2 * half_arc, at.xy, at.yaw_rad, sign / radius, slope});
    at.xy =
        points[i + 1].xy + tangent * Eigen::Vector2d(std::cos(heading + angle), std::sin(heading + angle));
    at.yaw_rad += angle;
  }
  course->plan(path_);
  append(course->duration(), [course, begin_m = now_.walked_m](double t) {
    WalkState state = course->at(t);
    state.walked_m += begin_m;
    return state;
  });
}

}  // namespace sgraphs::simulate
