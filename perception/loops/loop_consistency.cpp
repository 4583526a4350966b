#include "perception/loops/loop_consistency.h"

#include <bit>
#include <cmath>

namespace sgraphs {
namespace {

constexpr double kBase_m = 0.10;
constexpr double kBase_rad = 0.02;
constexpr double kSigmas = 3.0;

double sigmaOf(const MeasuredLoop& loop, Eigen::Index offset) {
  return std::sqrt(loop.covariance.block<3, 3>(offset, offset).trace());
}

// Bron and Kerbosch's search with a bound: `chosen` is joined to all `open`.
void grow(const std::vector<uint64_t>& neighbours, uint64_t chosen, uint64_t open, uint64_t& best) {
  if (open == 0) {
    if (std::popcount(chosen) > std::popcount(best)) best = chosen;
    return;
  }
  while (open != 0) {
    if (std::popcount(chosen) + std::popcount(open) <= std::popcount(best)) return;
    const int i = std::countr_zero(open);
    const uint64_t bit = uint64_t{1} << i;
    open &= ~bit;
    grow(neighbours, chosen | bit, open & neighbours[static_cast<size_t>(i)], best);
  }
}

}  // namespace

bool consistent(const MeasuredLoop& a, const MeasuredLoop& b, const WalkedPath& path) {
  const SE3 from_a_from_b = path.odometryOf(a.from).inverse() * path.odometryOf(b.from);
  const SE3 to_b_to_a = path.odometryOf(b.to).inverse() * path.odometryOf(a.to);
  const SE3 cycle = a.T_from_to.inverse() * from_a_from_b * b.T_from_to * to_b_to_a;
  const LoopGate old_path = path.along(a.from, b.from);
  const LoopGate new_path = path.along(a.to, b.to);
  const double rad =
      kBase_rad + old_path.yaw_rad + new_path.yaw_rad + kSigmas * std::hypot(sigmaOf(a, 3), sigmaOf(b, 3));
  // A loop's error of rotation moves what lies on the far side of the other path.
  const double lever_m = to_b_to_a.translation.norm();
  const double m = kBase_m + old_path.radius_m + new_path.radius_m +
                   kSigmas * std::hypot(sigmaOf(a, 0), sigmaOf(b, 0)) +
                   lever_m * kSigmas * std::hypot(sigmaOf(a, 3), sigmaOf(b, 3));
  return cycle.translation.norm() <= m && so3Log(cycle.rotation).norm() <= rad;
}

uint64_t largestClique(const std::vector<uint64_t>& neighbours) {
  const size_t n = neighbours.size();
  uint64_t best = 0;
  grow(neighbours, 0, n >= 64 ? ~uint64_t{0} : (uint64_t{1} << n) - 1, best);
  return best;
}

}  // namespace sgraphs
