#pragma once

#include <cmath>
#include <random>
#include <vector>

#include "common/io/ply.h"
#include "common/io/tum.h"

namespace sgraphs::test {

// 100 Hz for 20 s on a curve through all three dimensions.
inline std::vector<StampedPose> curvedTruth() {
  std::vector<StampedPose> truth;
  for (int i = 0; i <= 2000; ++i) {
    const double t = 0.01 * i;
    const Eigen::Quaterniond q(Eigen::AngleAxisd(0.3 * t, Eigen::Vector3d(0.1, 0.2, 1).normalized()));
    truth.push_back({{1'000'000'000 + i * 10'000},
                     {q, {3 * std::cos(0.3 * t), 2 * std::sin(0.3 * t), 0.3 * std::sin(t)}}});
  }
  return truth;
}

// Every n-th pose, as another frame sees it.
inline std::vector<StampedPose> everyNth(const std::vector<StampedPose>& truth, size_t n,
                                         const SE3& T_map_truth) {
  std::vector<StampedPose> poses;
  for (size_t i = 0; i < truth.size(); i += n) poses.push_back({truth[i].time, T_map_truth * truth[i].pose});
  return poses;
}

inline Eigen::Vector3d gaussian(std::mt19937& random, double sigma) {
  std::normal_distribution<double> normal(0, sigma);
  return {normal(random), normal(random), normal(random)};
}

// A rectangle of two triangles from `corner` along two edges.
inline TriangleMesh rectangle(const Eigen::Vector3d& corner, const Eigen::Vector3d& u,
                              const Eigen::Vector3d& v) {
  return {{corner, corner + u, corner + u + v, corner + v}, {{0, 1, 2}, {0, 2, 3}}};
}

inline const SE3 kSomeTransform(Eigen::Quaterniond(0.8, -0.3, 0.4, 0.33).normalized(), {10, -4, 2});

}  // namespace sgraphs::test
