#include "backend/planes/building_axes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "backend/planes/plane_extent.h"

namespace sgraphs {
namespace {

// Walls further off upright than this say nothing of the axes.
constexpr double kUprightForAxes = 0.1;  // |n.up|
constexpr double kQuarterTurn_rad = M_PI / 2;
constexpr int kBins = 45;  // of 2 degrees over a quarter turn

struct Heading {
  double angle_rad;  // in [0, pi/2)
  double weight;
};

double wrapQuarter(double angle_rad) {
  return angle_rad - kQuarterTurn_rad * std::round(angle_rad / kQuarterTurn_rad);
}

// Axes of the map's horizontal plane: e1 is the map's x made perpendicular to up.
struct Horizontal {
  Eigen::Vector3d e1, e2;
  explicit Horizontal(const Eigen::Vector3d& up)
      : e1((Eigen::Vector3d::UnitX() - up.x() * up).normalized()), e2(up.cross(e1)) {}
  double headingOf(const Eigen::Vector3d& n) const { return std::atan2(n.dot(e2), n.dot(e1)); }
};

}  // namespace

// The fullest three bins of a circular histogram, then the mean of what lies within 6 degrees of it: walls at
// 28 degrees do not pull at the axes of the rest.
void BuildingAxes::update(const std::map<PlaneId, PlaneNode>& planes, const Eigen::Vector3d& up_map) {
  const Horizontal horizontal(up_map);
  std::vector<Heading> headings;
  std::array<double, kBins> bins{};
  for (const auto& [id, plane] : planes) {
    if (std::abs(plane.normal_map.dot(up_map)) > kUprightForAxes) continue;
    double angle = horizontal.headingOf(plane.normal_map);
    angle -= kQuarterTurn_rad * std::floor(angle / kQuarterTurn_rad);
    const double weight = extentArea(plane);
    headings.push_back({angle, weight});
    bins[std::min<size_t>(kBins - 1, static_cast<size_t>(angle / kQuarterTurn_rad * kBins))] += weight;
  }
  if (headings.empty()) return;
  size_t best = 0;
  double fullest = -1;
  for (size_t i = 0; i < kBins; ++i) {
    const double sum = bins[(i + kBins - 1) % kBins] + bins[i] + bins[(i + 1) % kBins];
    if (sum > fullest) {
      fullest = sum;
      best = i;
    }
  }
  const double rough = (static_cast<double>(best) + 0.5) / kBins * kQuarterTurn_rad;
  double sum = 0, weights = 0;
  for (const Heading& h : headings) {
    const double off = wrapQuarter(h.angle_rad - rough);
    if (std::abs(off) > 6.0 * M_PI / 180) continue;
    sum += h.weight * off;
    weights += h.weight;
  }
  const double heading = rough + (weights > 0 ? sum / weights : 0);
  heading_rad_ = heading_rad_ + wrapQuarter(heading - heading_rad_);
}

PlaneLabel BuildingAxes::label(const Eigen::Vector3d& normal_map, const Eigen::Vector3d& up_map) const {
  const double x = std::abs(normal_map.dot(Horizontal(up_map).e1 * std::cos(heading_rad_) +
                                           Horizontal(up_map).e2 * std::sin(heading_rad_)));
  const double z = std::abs(normal_map.dot(up_map));
  const double y = std::sqrt(std::max(0.0, 1.0 - x * x - z * z));
  if (z >= x && z >= y) return PlaneLabel::kHorizontal;
  return x >= y ? PlaneLabel::kX : PlaneLabel::kY;
}

}  // namespace sgraphs
