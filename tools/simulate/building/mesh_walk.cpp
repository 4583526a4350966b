#include "tools/simulate/building/mesh_walk.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>

#include "tools/simulate/scene/fault_text.h"

namespace sgraphs::simulate {
namespace {

constexpr double kHeadroom_m = 1.2;
constexpr double kLevelCosine = 0.7;  // a surface flatter than 45 degrees
constexpr double kPastSurface_m = 1e-3;
constexpr double kStep_m = 0.05;  // along the path, between looks around
constexpr int kBearings = 24;
constexpr double kLowest_m = 0.2;  // thresholds and carpets are stepped over
constexpr double kBetweenHeights_m = 0.1;

// Where the body stands on its way.
struct Stand {
  Eigen::Vector2d xy = Eigen::Vector2d::Zero();
  double surface_z_m = 0;
  double steepness = 0;  // rise per distance walked: on stairs the next step is not in the way
};

std::string placeText(const Eigen::Vector2d& xy) {
  char buffer[64];
  std::snprintf(buffer, sizeof buffer, "(%.2f, %.2f)", xy.x(), xy.y());
  return buffer;
}

std::string waypointItem(size_t waypoint) {
  return item("path.waypoints", waypoint);
}

// Looks at what the body's band, from its knees to its LiDAR, meets.
class BodyBand {
 public:
  BodyBand(const RayCaster& mesh, double clearance_m, double top_m)
      : mesh_(mesh), clearance_m_(clearance_m), top_m_(top_m) {}

  // Distance to the nearest surface within the clearance, or nothing.
  std::optional<double> distanceAt(const Stand& stand) const {
    const double low = lowest(stand), high = std::max(low, top_m_);
    double nearest = std::numeric_limits<double>::infinity();
    for (const double height : heights(low, high))
      for (int i = 0; i < kBearings; ++i)
        if (const auto hit = mesh_.cast(at(stand, stand.xy, height), bearing(i), clearance_m_))
          nearest = std::min(nearest, hit->range_m);
    // Tops of tables lie between the heights.
    for (const double radius : {0.0, 0.5 * clearance_m_, clearance_m_})
      for (int i = 0; i < (radius > 0 ? kBearings : 1); ++i) {
        const Eigen::Vector2d beside = stand.xy + radius * bearing(i).head<2>();
        if (mesh_.cast(at(stand, beside, low), Eigen::Vector3d::UnitZ(), high - low))
          nearest = std::min(nearest, radius);
      }
    if (nearest >= clearance_m_ && !std::isfinite(nearest)) return std::nullopt;
    return nearest;
  }

  // A surface lies between two places.
  bool blocked(const Stand& from, const Stand& to) const {
    const double low = lowest(to), high = std::max(low, top_m_);
    for (const double height : heights(low, high)) {
      const Eigen::Vector3d a = at(from, from.xy, height), b = at(to, to.xy, height);
      const double length = (b - a).norm();
      if (length > 0 && mesh_.cast(a, (b - a) / length, length)) return true;
    }
    return false;
  }

 private:
  static Eigen::Vector3d bearing(int i) {
    const double angle = 2 * std::numbers::pi * i / kBearings;
    return {std::cos(angle), std::sin(angle), 0};
  }
  static Eigen::Vector3d at(const Stand& stand, const Eigen::Vector2d& xy, double height) {
    return {xy.x(), xy.y(), stand.surface_z_m + height};
  }
  double lowest(const Stand& stand) const {
    if (stand.steepness < 1e-3) return kLowest_m;
    return kLowest_m + 0.2 + stand.steepness * clearance_m_;  // over the riser ahead
  }
  static std::vector<double> heights(double low, double high) {
    const int gaps = static_cast<int>(std::ceil((high - low) / kBetweenHeights_m));
    std::vector<double> out;
    for (int i = 0; i <= gaps; ++i) out.push_back(low + (high - low) * i / std::max(1, gaps));
    return out;
  }

  const RayCaster& mesh_;
  double clearance_m_, top_m_;
};

std::string tooClose(double distance, double clearance) {
  char buffer[128];
  if (distance < 0.01)
    std::snprintf(buffer, sizeof buffer, " goes through the mesh: keep %.2g m from it", clearance);
  else
    std::snprintf(buffer, sizeof buffer, " is %.2f m from the mesh: keep %.2g m", distance, clearance);
  return buffer;
}

// The leg that a place on the walk, which rounds corners, is nearest to.
std::string legNear(const WalkPath& path, const Eigen::Vector2d& xy) {
  size_t best = 0;
  double nearest = std::numeric_limits<double>::infinity();
  for (size_t i = 0; i + 1 < path.waypoints.size(); ++i) {
    const Eigen::Vector2d a = path.waypoints[i].xy, leg = path.waypoints[i + 1].xy - a;
    const double s = std::clamp((xy - a).dot(leg) / std::max(1e-12, leg.squaredNorm()), 0.0, 1.0);
    const double distance = (a + s * leg - xy).norm();
    if (distance >= nearest) continue;
    nearest = distance;
    best = i;
  }
  return "the path from " + waypointItem(best) + " to " + waypointItem(best + 1) + ", at " + placeText(xy) +
         ",";
}

// The walk without the gait's sway, every kStep_m.
std::vector<Stand> standsAlong(const WalkPath& path, double floor_z_m) {
  WalkPath steady = path;
  steady.gait.bob_m = 0;
  const Trajectory walk = walkAlong(steady, Time{}, floor_z_m);
  const double seconds = walk.duration().seconds();
  const int steps = static_cast<int>(std::ceil(seconds * path.speed_mps / kStep_m));
  std::vector<Stand> stands;
  for (int k = 0; k <= steps; ++k) {
    const Eigen::Vector3d p = walk.poseAtOffset(seconds * k / std::max(1, steps)).translation;
    Stand stand{p.head<2>(), p.z() - path.body_height_m, 0};
    if (!stands.empty()) {
      const Stand& before = stands.back();
      const double moved = (stand.xy - before.xy).norm();
      if (moved < 0.2 * kStep_m && k < steps) continue;  // standing
      if (moved > 0.1 * kStep_m) stand.steepness = std::abs(stand.surface_z_m - before.surface_z_m) / moved;
    }
    stands.push_back(stand);
  }
  return stands;
}

}  // namespace

std::vector<double> walkingSurfaces(const RayCaster& mesh, const Eigen::Vector2d& xy, double z_min_m,
                                    double z_max_m) {
  std::vector<double> found;
  double ceiling = std::numeric_limits<double>::infinity();
  double from = z_max_m + 1;
  while (const auto hit = mesh.cast({xy.x(), xy.y(), from}, -Eigen::Vector3d::UnitZ(), from - z_min_m + 1)) {
    const double z = from - hit->range_m;
    if (hit->cos_incidence > kLevelCosine && ceiling - z > kHeadroom_m) found.push_back(z);
    ceiling = z;
    from = z - kPastSurface_m;
  }
  std::reverse(found.begin(), found.end());
  return found;
}

std::optional<std::string> meshWalkFault(const RayCaster& mesh, const WalkPath& path, double floor_z_m,
                                         double top_m) {
  const BodyBand band(mesh, path.clearance_m, top_m);
  const std::vector<Stand> stands = standsAlong(path, floor_z_m);
  for (size_t i = 0; i < path.waypoints.size(); ++i) {
    const Waypoint& waypoint = path.waypoints[i];
    // As steep as the walk is there.
    const auto here = std::min_element(stands.begin(), stands.end(), [&](const Stand& a, const Stand& b) {
      return (a.xy - waypoint.xy).norm() < (b.xy - waypoint.xy).norm();
    });
    double steepness = here->steepness;
    if (here != stands.begin()) steepness = std::max(steepness, std::prev(here)->steepness);
    if (std::next(here) != stands.end()) steepness = std::max(steepness, std::next(here)->steepness);
    const Stand stand{waypoint.xy, floor_z_m + waypoint.rise_m, steepness};
    if (const auto distance = band.distanceAt(stand))
      return waypointItem(i) + " at " + placeText(waypoint.xy) + tooClose(*distance, path.clearance_m);
  }
  for (size_t k = 0; k < stands.size(); ++k) {
    if (k > 0 && band.blocked(stands[k - 1], stands[k]))
      return legNear(path, stands[k].xy) + tooClose(0, path.clearance_m);
    if (const auto distance = band.distanceAt(stands[k]))
      return legNear(path, stands[k].xy) + tooClose(*distance, path.clearance_m);
  }
  return std::nullopt;
}

}  // namespace sgraphs::simulate
