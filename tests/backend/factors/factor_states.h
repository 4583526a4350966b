#pragma once

#include <Eigen/Core>
#include <array>
#include <random>

#include "backend/factors/plane_manifold.h"
#include "backend/factors/pose_manifold.h"

namespace sgraphs::test {

// States as the solver keeps them.
using Storage = std::array<double, 7>;

inline Storage stored(const PlaneState& plane) {
  Storage x{};
  PlaneManifold::store(plane, x.data());
  return x;
}

inline Storage stored(const SE3& T) {
  Storage x{};
  PoseManifold::store(T, x.data());
  return x;
}

inline Eigen::VectorXd gaussian(int size, double sigma, std::mt19937& random) {
  std::normal_distribution<double> normal(0.0, sigma);
  Eigen::VectorXd v(size);
  for (int i = 0; i < size; ++i) v(i) = normal(random);
  return v;
}

inline Eigen::VectorXd randomPose(std::mt19937& random) {
  Eigen::VectorXd x = gaussian(7, 3.0, random);
  x.tail<4>().normalize();
  return x;
}

}  // namespace sgraphs::test
