#include "tests/backend/synthetic_walk.h"

namespace sgraphs::testing_support {
namespace {

Vector6d gaussian(const Vector6d& sigma, std::mt19937& random) {
  std::normal_distribution<double> normal;
  Vector6d v;
  for (int i = 0; i < 6; ++i) v(i) = sigma(i) * normal(random);
  return v;
}

RelativePose measure(const Walk& walk, int from, int to, RelativePoseKind kind, const Vector6d& sigma,
                     std::mt19937& random) {
  RelativePose z;
  z.kind = kind;
  z.from = KeyframeId{from};
  z.to = KeyframeId{to};
  z.T_from_to = walk.truth[static_cast<size_t>(from)].inverse() * walk.truth[static_cast<size_t>(to)] *
                se3Exp(gaussian(sigma, random));
  z.covariance = sigma.cwiseAbs2().asDiagonal();
  return z;
}

std::vector<SE3> makeTruth(const WalkOptions& options, std::mt19937& random) {
  std::vector<SE3> truth{{so3Exp(options.start_tilt), Eigen::Vector3d::Zero()}};
  Vector6d spread;
  spread << 0.1, 0.1, 0.0, 0.01, 0.01, 0.3;
  double heading = 0;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  for (int k = 1; k < options.num_keyframes; ++k) {
    const Vector6d draw = gaussian(spread, random);
    heading += draw(5);
    position += Eigen::Vector3d(std::cos(heading), std::sin(heading), 0) + draw.head<3>();
    truth.emplace_back(so3Exp({0, 0, heading}) * so3Exp({draw(3), draw(4), 0}), position);
  }
  return truth;
}

}  // namespace

Walk makeWalk(const WalkOptions& options) {
  std::mt19937 random(options.seed);
  std::normal_distribution<double> normal;
  Walk walk;
  walk.truth = makeTruth(options, random);
  Vector6d sigma;
  sigma << Eigen::Vector3d::Constant(options.sigma_m), Eigen::Vector3d::Constant(options.sigma_rad);
  SE3 T_odom_body = se3Exp((Vector6d() << 3, 1, 0, 0, 0, 0.5).finished());
  for (int k = 0; k < options.num_keyframes; ++k) {
    Keyframe keyframe;
    keyframe.id = KeyframeId{k};
    keyframe.time = Time{1'000'000 + 500'000LL * k};
    if (k >= 1) {
      keyframe.relative_poses.push_back(measure(walk, k - 1, k, RelativePoseKind::kOdometry, sigma, random));
      T_odom_body = T_odom_body * keyframe.relative_poses[0].T_from_to;
    }
    if (k >= 2 && options.neighbours)
      keyframe.relative_poses.push_back(measure(walk, k - 2, k, RelativePoseKind::kNeighbour, sigma, random));
    if (options.loop_every > 0 && k > 20 && k % options.loop_every == 0) {
      const int to = static_cast<int>(random() % static_cast<unsigned>(k - 15));
      keyframe.relative_poses.push_back(measure(walk, to, k, RelativePoseKind::kLoop, sigma, random));
    }
    keyframe.T_odom_body = T_odom_body;
    if (options.up_sigma_rad > 0) {
      const Eigen::Vector3d tilt(options.up_sigma_rad * normal(random), options.up_sigma_rad * normal(random),
                                 0);
      keyframe.up_body = (so3Exp(tilt) * (walk.truth[static_cast<size_t>(k)].rotation.conjugate() *
                                          Eigen::Vector3d::UnitZ()))
                             .normalized();
      keyframe.up_sigma_rad = options.up_sigma_rad;
    }
    walk.keyframes.push_back(std::move(keyframe));
  }
  return walk;
}

}  // namespace sgraphs::testing_support
