#include "tools/simulate/building/people.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace sgraphs::simulate {
namespace {

constexpr uint8_t kClothesReflectivity = 30;

// A grown body, in shares of its height or metres.
constexpr double kHip = 0.47;   // where the legs end
constexpr double kNeck = 0.86;  // where the head begins
constexpr double kLegRadius_m = 0.075;
constexpr double kHeadRadius_m = 0.09;
constexpr double kLegSpacing_m = 0.1;  // of each leg from the middle
constexpr double kStride_m = 1.4;      // distance of two steps
constexpr double kSwing_m = 0.2;       // of each leg forward and back

}  // namespace

std::optional<RayHit> intersect(const UprightCylinder& cylinder, const Eigen::Vector3d& origin,
                                const Eigen::Vector3d& direction, uint8_t reflectivity) {
  // |d + t u|^2 = r^2 in the plane; the side is entered at the smaller root.
  const Eigen::Vector2d d = origin.head<2>() - cylinder.center, u = direction.head<2>();
  const double a = u.squaredNorm(), b = d.dot(u), c = d.squaredNorm() - std::pow(cylinder.radius_m, 2);
  const double root = b * b - a * c;
  if (c > 0 && a > 0 && root >= 0) {
    const double t = (-b - std::sqrt(root)) / a, z = origin.z() + t * direction.z();
    if (t >= 0 && z >= cylinder.z_min_m && z <= cylinder.z_max_m)
      return RayHit{t, std::min(1.0, -(d + t * u).dot(u) / cylinder.radius_m), reflectivity};
  }
  // The lid that faces the ray.
  if (direction.z() == 0) return std::nullopt;
  const double lid = direction.z() < 0 ? cylinder.z_max_m : cylinder.z_min_m;
  const double t = (lid - origin.z()) / direction.z();
  if (t < 0 || (d + t * u).norm() > cylinder.radius_m) return std::nullopt;
  return RayHit{t, std::abs(direction.z()), reflectivity};
}

std::optional<RayHit> PeopleNow::cast(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                                      double max_range_m) const {
  std::optional<RayHit> first;
  const Eigen::Vector2d u = direction.head<2>();
  const double flat = u.norm();
  for (const Body& body : bodies_) {
    // Most rays pass far from most people.
    const Eigen::Vector2d d = body.center - origin.head<2>();
    const double reach = body.reach_m;
    if (std::abs(u.x() * d.y() - u.y() * d.x()) > reach * flat || u.dot(d) < -reach * flat) continue;
    for (const UprightCylinder& part : body.parts)
      if (const auto hit = intersect(part, origin, direction, kClothesReflectivity);
          hit && hit->range_m <= (first ? first->range_m : max_range_m))
        first = hit;
  }
  return first;
}

People::People(const std::vector<Person>& people, const std::vector<double>& floors_z_m) {
  for (const Person& person : people) {
    Walker walker{person, floors_z_m[static_cast<size_t>(person.floor)], {0.0}};
    for (size_t i = 1; i < person.waypoints.size(); ++i)
      walker.distance_m.push_back(walker.distance_m.back() +
                                  (person.waypoints[i] - person.waypoints[i - 1]).norm());
    walkers_.push_back(std::move(walker));
  }
}

PeopleNow People::at(double seconds) const {
  PeopleNow now;
  for (const Walker& walker : walkers_) now.add(bodyOf(walker, seconds));
  return now;
}

PeopleNow::Body People::bodyOf(const Walker& walker, double seconds) {
  const Person& person = walker.person;
  const double length = walker.distance_m.back();
  const double walked = std::max(0.0, seconds - person.start_s) * person.speed_mps;
  // There and back again.
  const double phase = length > 0 ? std::fmod(walked, 2 * length) : 0.0;
  const bool back = phase > length;
  const double along = back ? 2 * length - phase : phase;
  Eigen::Vector2d xy = person.waypoints.front(), forward(1, 0);
  if (length > 0) {
    const auto next = std::upper_bound(walker.distance_m.begin() + 1, walker.distance_m.end() - 1, along);
    const auto i = static_cast<size_t>(next - walker.distance_m.begin());
    const Eigen::Vector2d leg = person.waypoints[i] - person.waypoints[i - 1];
    forward = leg.normalized();
    xy = person.waypoints[i - 1] + (along - walker.distance_m[i - 1]) * forward;
    if (back) forward = -forward;
  }
  const double swing = length > 0 ? kSwing_m * std::sin(2 * std::numbers::pi * walked / kStride_m) : 0.0;
  const Eigen::Vector2d left(-forward.y(), forward.x());
  const double z = walker.floor_z_m, height = person.height_m;
  const Eigen::Vector2d step = swing * forward, aside = kLegSpacing_m * left;
  PeopleNow::Body body;
  body.center = xy;
  body.parts = {UprightCylinder{xy + aside + step, kLegRadius_m, z, z + kHip * height},
                UprightCylinder{xy - aside - step, kLegRadius_m, z, z + kHip * height},
                UprightCylinder{xy, person.radius_m, z + kHip * height, z + kNeck * height},
                UprightCylinder{xy, kHeadRadius_m, z + kNeck * height, z + height}};
  body.reach_m = std::max(person.radius_m, std::hypot(kLegSpacing_m, kSwing_m) + kLegRadius_m);
  return body;
}

}  // namespace sgraphs::simulate
