#include "perception/odometry/floor_under_start.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace sgraphs {
namespace {

constexpr double kMinCos = 0.87;   // 30 degrees
constexpr double kBelow_m = -0.2;  // the floor lies below the body's origin
constexpr double kFloorReach_m = 6.0;
constexpr double kGate_m = 0.05;
constexpr size_t kMinPatches = 20;
constexpr double kSigmaFloor_rad = 0.005;

}  // namespace

std::optional<UpDirection> floorUnderStart(const std::vector<Surfel>& surfels) {
  std::vector<const Surfel*> candidates;
  for (const Surfel& s : surfels)
    if (s.normal.z() > kMinCos && s.mean.z() < kBelow_m && s.mean.head<2>().norm() < kFloorReach_m)
      candidates.push_back(&s);
  if (candidates.size() < kMinPatches) return std::nullopt;
  // z = a x + b y + c, refitted to the patches within the gate; the first fit is a level plane at the median
  // height.
  std::vector<double> heights;
  heights.reserve(candidates.size());
  for (const Surfel* s : candidates) heights.push_back(s->mean.z());
  std::nth_element(heights.begin(), heights.begin() + static_cast<std::ptrdiff_t>(heights.size() / 2),
                   heights.end());
  Eigen::Vector3d plane(0, 0, heights[heights.size() / 2]);
  Eigen::Matrix3d A = Eigen::Matrix3d::Zero();
  double squares = 0;
  size_t used = 0;
  // The gate narrows from what a tilt of the body can do to what a floor's roughness is.
  for (const double gate_m : {0.6, 0.3, 0.15, kGate_m, kGate_m}) {
    A.setZero();
    Eigen::Vector3d b = Eigen::Vector3d::Zero();
    squares = 0;
    used = 0;
    for (const Surfel* s : candidates) {
      const Eigen::Vector3d row(s->mean.x(), s->mean.y(), 1.0);
      const double r = s->mean.z() - row.dot(plane);
      if (std::abs(r) > gate_m) continue;
      A += row * row.transpose();
      b += row * s->mean.z();
      squares += r * r;
      ++used;
    }
    if (used < kMinPatches) return std::nullopt;
    plane = A.ldlt().solve(b);
  }
  const Eigen::Matrix3d covariance = (squares / static_cast<double>(used)) * A.inverse();
  const double fit = std::sqrt(std::max(covariance(0, 0), covariance(1, 1)));
  if (!std::isfinite(fit)) return std::nullopt;
  return UpDirection{Eigen::Vector3d(-plane.x(), -plane.y(), 1.0).normalized(),
                     std::hypot(kSigmaFloor_rad, fit)};
}

}  // namespace sgraphs
