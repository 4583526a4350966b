#include "tests/backend/planes/ring_walk.h"

#include <algorithm>
#include <cmath>

namespace sgraphs::testing_support {
namespace {

constexpr double kOuter_m = 8, kInner_m = 6, kPath_m = 7, kHeight_m = 2.6, kReach_m = 6, kLeastHalf_m = 0.4;

std::vector<Face> makeFaces(const RingOptions& options) {
  std::vector<Face> faces;
  for (int side = 0; side < 4; ++side) {
    const Eigen::Vector3d out = so3Exp({0, 0, side * M_PI / 2}) * Eigen::Vector3d::UnitX();
    const Eigen::Vector3d lift(0, 0, kHeight_m / 2);
    const Eigen::Vector3d normal = so3Exp({0, 0, side == 0 ? options.wall_off_square_rad : 0.0}) * -out;
    faces.push_back({kOuter_m * out + lift, normal, kOuter_m, kHeight_m / 2});
    faces.push_back({kInner_m * out + lift, out, kInner_m, kHeight_m / 2});
  }
  if (!options.floor_and_ceiling) return faces;
  faces.push_back({{0, 0, 0}, {0, 0, 1}, kOuter_m, kOuter_m});
  faces.push_back({{0, 0, kHeight_m}, {0, 0, -1}, kOuter_m, kOuter_m});
  return faces;
}

// Along the middle of the corridor, counter-clockwise, from the middle of the side at +x.
SE3 poseAt(double s) {
  const double side = 2 * kPath_m;
  s = std::fmod(s + kPath_m, 4 * side);
  const int k = static_cast<int>(s / side);
  const Eigen::Quaterniond q = so3Exp({0, 0, k * M_PI / 2});
  const Eigen::Vector3d p = q * Eigen::Vector3d(kPath_m, s - k * side - kPath_m, 0.6);
  return {q * so3Exp({0, 0, M_PI / 2}), p};
}

Vector6d draw(double sigma_m, double sigma_rad, std::mt19937& random) {
  std::normal_distribution<double> normal;
  Vector6d v;
  for (int i = 0; i < 6; ++i) v(i) = (i < 3 ? sigma_m : sigma_rad) * normal(random);
  return v;
}

}  // namespace

RingWalk makeRingWalk(const RingOptions& options) {
  std::mt19937 random(options.seed);
  RingWalk walk;
  walk.faces = makeFaces(options);
  const double length = options.laps * 8 * kPath_m;
  const SE3 turn(so3Exp({0, 0, options.start_heading_rad}), Eigen::Vector3d::Zero());
  SE3 T_odom_body;
  for (int64_t k = 0; static_cast<double>(k) * options.step_m < length; ++k) {
    // The body's own heading is off its path by the start heading: the map is turned against the building.
    walk.truth.push_back(poseAt(static_cast<double>(k) * options.step_m) * turn);
    const SE3& T = walk.truth.back();
    Keyframe keyframe;
    keyframe.id = KeyframeId{k};
    keyframe.time = Time{1'000'000 * (k + 1)};
    if (k > 0) {
      RelativePose z;
      z.from = KeyframeId{k - 1};
      z.to = keyframe.id;
      z.T_from_to = walk.truth[static_cast<size_t>(k - 1)].inverse() * T *
                    se3Exp(draw(options.sigma_m, options.sigma_rad, random));
      Vector6d sigma;
      sigma << Eigen::Vector3d::Constant(options.sigma_m), Eigen::Vector3d::Constant(options.sigma_rad);
      z.covariance = sigma.cwiseAbs2().asDiagonal();
      keyframe.relative_poses.push_back(z);
      T_odom_body = T_odom_body * z.T_from_to;
    }
    keyframe.T_odom_body = T_odom_body;
    KeyframePlanes planes;
    planes.keyframe = keyframe.id;
    planes.time = keyframe.time;
    for (const Face& face : walk.faces)
      if (const auto part = visiblePart(face, T, kReach_m, kLeastHalf_m))
        planes.planes.push_back(noisy(observe(*part, T), random));
    walk.planes.push_back(std::move(planes));
    walk.keyframes.push_back(std::move(keyframe));
  }
  return walk;
}

}  // namespace sgraphs::testing_support
