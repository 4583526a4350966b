#include "tools/simulate/scene/obstacles.h"

#include <algorithm>
#include <cmath>

#include "tools/simulate/building/building.h"
#include "tools/simulate/scene/fault_text.h"

namespace sgraphs::simulate {
namespace {

constexpr double kThreshold_m = 0.05;       // lower things are stepped over
constexpr double kHighestSlabEdge_m = 0.3;  // over the slope that leads there
constexpr double kLidarOverBody_m = 0.5;

std::string named(const std::string& place, const std::string& name) {
  return name.empty() ? place : place + " '" + name + "'";
}

double riserOf(const Stairs& stairs) {
  return (stairs.z_max_m - stairs.z_min_m) / stairs.steps;
}

}  // namespace

std::optional<double> slopeHeight(const Stairs& stairs, const Eigen::Vector2d& xy, double margin_m) {
  const double length = (stairs.top - stairs.foot).norm();
  const Eigen::Vector2d u = (stairs.top - stairs.foot) / length, d = xy - stairs.foot;
  const double along = u.dot(d), across = std::abs(u.x() * d.y() - u.y() * d.x());
  if (across > 0.5 * stairs.width_m || along < -margin_m || along > length + margin_m) return std::nullopt;
  return stairs.z_min_m + (stairs.z_max_m - stairs.z_min_m) * std::clamp(along / length, 0.0, 1.0);
}

Obstacles::Obstacles(const Scene& scene)
    : clearance_m_(scene.path.clearance_m),
      body_top_m_(scene.path.body_height_m + kLidarOverBody_m),
      flights_(scene.stairs) {
  for (size_t i = 0; i < scene.walls.size(); ++i) {
    // A pane stands in the way as the wall would.
    auto openings = openingsOf(scene, scene.walls[i]);
    std::erase_if(openings, [](const Opening& opening) { return opening.glazed; });
    for (const WallPart& part : wallParts(scene.walls[i], openings))
      add(item("walls", i), boxOf(scene.walls[i], part));
  }
  for (size_t i = 0; i < scene.boxes.size(); ++i)
    add(named(item("boxes", i), scene.boxes[i].name), scene.boxes[i]);
  for (size_t i = 0; i < scene.columns.size(); ++i)
    addColumn(named(item("columns", i), scene.columns[i].name), scene.columns[i]);
  for (size_t i = 0; i < scene.stairs.size(); ++i)
    addFlight(item("stairs", i), scene.stairs[i], static_cast<int>(i));
  const auto slabs = slabsOf(scene);
  for (size_t i = 0; i < slabs.size(); ++i) {
    const Slab& slab = slabs[i];
    const std::string name = scene.slabs.empty() ? "the slab of floors between z " + text(slab.z_min_m) +
                                                       " and " + text(slab.z_max_m)
                                                 : item("slabs", i);
    add(name, {"", 0.5 * (slab.min + slab.max), slab.max - slab.min, slab.z_min_m, slab.z_max_m, 0}, true);
  }
}

void Obstacles::add(const std::string& name, const Box& box, bool slab, int flight) {
  const Eigen::Vector2d axis(std::cos(box.yaw_rad), std::sin(box.yaw_rad));
  solids_.push_back({name, box.center, axis, 0.5 * box.size, 0.0, box.z_min_m, box.z_max_m,
                     0.5 * box.size.norm() + clearance_m_, flight, slab});
}

void Obstacles::addColumn(const std::string& name, const Column& column) {
  solids_.push_back({name, column.center, Eigen::Vector2d::UnitX(), Eigen::Vector2d::Zero(), column.radius_m,
                     column.z_min_m, column.z_max_m, column.radius_m + clearance_m_});
}

void Obstacles::addFlight(const std::string& name, const Stairs& stairs, int index) {
  const Eigen::Vector2d run = stairs.top - stairs.foot;
  for (int k = 0; k < stairs.steps; ++k) {
    Box step;
    step.center = stairs.foot + run * (k + 0.5) / stairs.steps;
    step.size = {run.norm() / stairs.steps, stairs.width_m};
    step.z_min_m = stairs.z_min_m;
    step.z_max_m = stairs.z_min_m + riserOf(stairs) * (k + 1);
    step.yaw_rad = std::atan2(run.y(), run.x());
    add(name, step, false, index);
  }
}

bool Obstacles::inTheWay(const Solid& solid, const Foothold& at) const {
  if (solid.z_min_m > at.z_m + body_top_m_ || solid.z_max_m < at.z_m + kThreshold_m) return false;
  if (solid.slab && solid.z_max_m < at.z_m + kHighestSlabEdge_m) return false;
  if (solid.flight < 0) return true;
  // A flight is no obstacle to a body that climbs it.
  const Stairs& stairs = flights_[static_cast<size_t>(solid.flight)];
  const auto slope_z = slopeHeight(stairs, at.xy, clearance_m_ + kThreshold_m);
  return !slope_z || std::abs(*slope_z - at.z_m) > riserOf(stairs) + kThreshold_m;
}

Obstacles::Nearest Obstacles::nearest(const Foothold& at) const {
  Nearest found;
  found.distance_m = clearance_m_;
  for (const Solid& solid : solids_) {
    const Eigen::Vector2d d = at.xy - solid.center;
    if (d.squaredNorm() > solid.reach_m * solid.reach_m) continue;
    const Eigen::Vector2d own(std::abs(solid.axis.dot(d)),
                              std::abs(solid.axis.x() * d.y() - solid.axis.y() * d.x()));
    const double footprint = (own - solid.half_size).cwiseMax(0.0).norm();
    const double distance = std::max(0.0, footprint - solid.radius_m);
    // One may pass close by the edge of a slab, but not through it.
    if (solid.slab && distance > 0) continue;
    if (distance >= found.distance_m || !inTheWay(solid, at)) continue;
    found = {solid.name, distance};
  }
  return found;
}

}  // namespace sgraphs::simulate
