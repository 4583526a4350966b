#include "backend/loops/odometry_chain.h"

#include <algorithm>
#include <vector>

namespace sgraphs {
namespace {

void append(RelativePose& way, const SE3& T, const Matrix6d& covariance) {
  way.covariance = composeCovariance(way.covariance, T, covariance);
  way.T_from_to = way.T_from_to * T;
}

}  // namespace

std::optional<RelativePose> OdometryChain::between(KeyframeId from, KeyframeId to) const {
  // Both ways go back to where they meet, which is `from` itself where every keyframe follows the last.
  std::vector<const RelativePose*> back, forth;
  KeyframeId a = from, b = to;
  while (a != b) {
    const auto step = from_.find(std::max(a, b));
    if (step == from_.end()) return std::nullopt;
    if (a > b) {
      back.push_back(&step->second);
      a = step->second.from;
    } else {
      forth.push_back(&step->second);
      b = step->second.from;
    }
  }
  RelativePose way;
  way.from = from;
  way.to = to;
  way.covariance.setZero();
  for (const RelativePose* z : back) {
    const Matrix6d Ad = se3Adjoint(z->T_from_to);
    append(way, z->T_from_to.inverse(), Ad * z->covariance * Ad.transpose());
  }
  for (auto z = forth.rbegin(); z != forth.rend(); ++z) append(way, (*z)->T_from_to, (*z)->covariance);
  // No sum of n errors has more than n times the sum of their covariances, which it has if they are all
  // alike.
  way.covariance *= static_cast<double>(std::max<size_t>(1, back.size() + forth.size()));
  return way;
}

}  // namespace sgraphs
