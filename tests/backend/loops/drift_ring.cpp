#include "tests/backend/loops/drift_ring.h"

#include <algorithm>
#include <cmath>

namespace sgraphs::testing_support {
namespace {

constexpr double kHalfWidth_m = 1.0, kHeight_m = 2.6, kReach_m = 6, kLeastHalf_m = 0.3, kBody_m = 0.6;
// Of what odometry states; the rest is for its bias.
constexpr double kNoiseShare = 0.25;
constexpr double kNicheEvery_m = 7, kNicheDepth_m = 0.8;

// Walls along the corridor, and niches' sides across it, of unequal spacing so that no two places look alike.
std::vector<Face> makeFaces(double side_m) {
  std::vector<Face> faces;
  const double half = side_m / 2;
  const Eigen::Vector3d lift(0, 0, kHeight_m / 2);
  for (int side = 0; side < 4; ++side) {
    const Eigen::Quaterniond q = so3Exp({0, 0, side * M_PI / 2});
    const Eigen::Vector3d out = q * Eigen::Vector3d::UnitX(), along = q * Eigen::Vector3d::UnitY();
    const double outer = half + kHalfWidth_m, inner = half - kHalfWidth_m;
    faces.push_back({outer * out + lift, -out, outer, kHeight_m / 2});
    faces.push_back({inner * out + lift, out, inner, kHeight_m / 2});
    int i = side;
    for (double s = -half + 4; s < half - 3; s += kNicheEvery_m + 0.6 * (i++ % 3)) {
      const Eigen::Vector3d at = (outer + kNicheDepth_m / 2) * out + s * along + lift;
      faces.push_back({at, along, kNicheDepth_m / 2, kHeight_m / 2});
      faces.push_back({at + 1.2 * along, -along, kNicheDepth_m / 2, kHeight_m / 2});
    }
  }
  faces.push_back({{0, 0, 0}, {0, 0, 1}, half + kHalfWidth_m, half + kHalfWidth_m});
  return faces;
}

SE3 poseAt(double s, double side_m) {
  s = std::fmod(s + side_m / 2, 4 * side_m);
  const int k = static_cast<int>(s / side_m);
  const Eigen::Quaterniond q = so3Exp({0, 0, k * M_PI / 2});
  return {q * so3Exp({0, 0, M_PI / 2}),
          q * Eigen::Vector3d(side_m / 2, s - k * side_m - side_m / 2, kBody_m)};
}

Vector6d draw(const Vector6d& sigma, std::mt19937& random) {
  std::normal_distribution<double> normal;
  Vector6d v;
  for (int i = 0; i < 6; ++i) v(i) = sigma(i) * normal(random);
  return v;
}

// The body is nearer to the middle of its side than half of open_m.
bool inTheOpen(const SE3& T, const DriftRingOptions& options) {
  const Eigen::Vector2d p = T.translation.head<2>().cwiseAbs();
  return p.minCoeff() < options.open_m / 2;
}

}  // namespace

LoopClosure DriftRing::loop(KeyframeId to, LoopId id) const {
  const SE3& T = truth[static_cast<size_t>(to.value)];
  size_t from = 0;
  for (size_t k = 0; k + 50 < static_cast<size_t>(to.value); ++k)
    if ((truth[k].translation - T.translation).norm() < (truth[from].translation - T.translation).norm())
      from = k;
  Vector6d sigma;
  sigma << Eigen::Vector3d::Constant(0.01), Eigen::Vector3d::Constant(0.002);
  std::mt19937 random(static_cast<uint32_t>(id.value + 1));
  LoopClosure loop;
  loop.id = id;
  loop.pose.kind = RelativePoseKind::kLoop;
  loop.pose.from = KeyframeId{static_cast<int64_t>(from)};
  loop.pose.to = to;
  loop.pose.registered = true;
  loop.pose.T_from_to = truth[from].inverse() * T * se3Exp(draw(sigma, random));
  loop.pose.covariance = sigma.cwiseAbs2().asDiagonal();
  loop.overlap = loop.inlier_share = 0.9;
  return loop;
}

DriftRing makeDriftRing(const DriftRingOptions& options) {
  std::mt19937 random(options.seed);
  DriftRing ring;
  ring.faces = makeFaces(options.side_m);
  Vector6d sigma;
  sigma << 0.012, 0.012, 0.003, 0.002, 0.002, 0.004;
  SE3 T_odom_body;
  for (int64_t k = 0; static_cast<double>(k) * options.step_m < options.laps * 4 * options.side_m; ++k) {
    ring.truth.push_back(poseAt(static_cast<double>(k) * options.step_m, options.side_m));
    const SE3& T = ring.truth.back();
    Keyframe keyframe;
    keyframe.id = KeyframeId{k};
    keyframe.time = Time{1'000'000 * (k + 1)};
    if (k > 0) {
      RelativePose z;
      z.from = KeyframeId{k - 1};
      z.to = keyframe.id;
      const SE3 step = ring.truth[static_cast<size_t>(k - 1)].inverse() * T;
      Vector6d error = kNoiseShare * draw(sigma, random);
      error(5) += options.yaw_bias_rad_per_m * options.step_m;
      error.head<3>() += options.scale_bias * (step.rotation.conjugate() * step.translation);
      z.T_from_to = step * se3Exp(error);
      z.covariance = sigma.cwiseAbs2().asDiagonal();
      keyframe.relative_poses.push_back(z);
      T_odom_body = T_odom_body * z.T_from_to;
    }
    keyframe.T_odom_body = T_odom_body;
    KeyframePlanes planes;
    planes.keyframe = keyframe.id;
    planes.time = keyframe.time;
    for (const Face& face : ring.faces) {
      if (std::abs(face.normal.z()) < 0.5 && inTheOpen(T, options)) continue;
      if (const auto part = visiblePart(face, T, kReach_m, kLeastHalf_m))
        planes.planes.push_back(noisy(observe(*part, T), random));
    }
    ring.planes.push_back(std::move(planes));
    ring.keyframes.push_back(std::move(keyframe));
  }
  return ring;
}

}  // namespace sgraphs::testing_support
