#include "common/geometry/se3.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

namespace sgraphs {
namespace {

Vector6d vec(double x, double y, double z, double wx, double wy, double wz) {
  Vector6d v;
  v << x, y, z, wx, wy, wz;
  return v;
}

// From the identity through every branch for small angles to close to half a turn.
std::vector<Vector6d> tangents() {
  return {Vector6d::Zero(),
          vec(1, -2, 3, 0, 0, 0),
          vec(1, -2, 3, 1e-9, -2e-9, 1e-9),
          vec(0.5, 0.1, -0.7, 7e-6, 3e-6, -6e-6),
          vec(0.5, 0.1, -0.7, 7e-5, -6e-5, 4e-5),
          vec(-1, 0.2, 0.3, 0.02, 0.03, -0.034),
          vec(-1, 0.2, 0.3, 0.03, 0.03, -0.034),
          vec(2, -1, 0.5, 0.4, -0.8, 0.3),
          vec(0.3, 4, -2, -1.2, 0.9, 1.7),
          vec(0.3, 4, -2, 3.0, 0.5, -0.6)};
}

double distance(const SE3& a, const SE3& b) {
  return se3Log(a.inverse() * b).norm();
}

TEST(Se3Test, ExponentialAndLogarithmAreInverse) {
  for (const Vector6d& xi : tangents()) EXPECT_LT((se3Log(se3Exp(xi)) - xi).norm(), 1e-12) << xi.transpose();
}

TEST(Se3Test, ExponentialIsThePowerSeries) {
  for (const Vector6d& xi : tangents()) {
    Eigen::Matrix4d generator = Eigen::Matrix4d::Zero(), term = Eigen::Matrix4d::Identity(), sum = term;
    generator.topLeftCorner<3, 3>() = skew(xi.tail<3>());
    generator.topRightCorner<3, 1>() = xi.head<3>();
    for (int n = 1; n < 60; ++n) {
      term = term * generator / n;
      sum += term;
    }
    const SE3 T = se3Exp(xi);
    EXPECT_LT((T.matrix3() - sum.topLeftCorner<3, 3>()).norm(), 1e-11) << xi.transpose();
    EXPECT_LT((T.translation - sum.topRightCorner<3, 1>()).norm(), 1e-11) << xi.transpose();
  }
}

TEST(Se3Test, LogarithmTakesTheShortWay) {
  const Eigen::Vector3d axis = Eigen::Vector3d(1, 2, -1).normalized();
  const Eigen::Quaterniond q = so3Exp(axis * 4.0);
  EXPECT_NEAR(so3Log(q).norm(), 2 * std::numbers::pi - 4.0, 1e-12);
  const Eigen::Quaterniond opposite(-q.w(), -q.x(), -q.y(), -q.z());
  EXPECT_LT((so3Log(q) - so3Log(opposite)).norm(), 1e-12);
}

TEST(Se3Test, CompositionAndInverseAgreeWithPoints) {
  const SE3 A = se3Exp(tangents()[7]), B = se3Exp(tangents()[8]);
  const Eigen::Vector3d p(0.3, -0.7, 2.0);
  EXPECT_LT(((A * B) * p - A * (B * p)).norm(), 1e-12);
  EXPECT_LT(distance(A * A.inverse(), SE3()), 1e-12);
}

TEST(Se3Test, AdjointCarriesATangentThroughATransform) {
  const SE3 T = se3Exp(tangents()[8]);
  for (const Vector6d& xi : tangents()) {
    const Vector6d small = 0.3 * xi;
    EXPECT_LT(distance(T * se3Exp(small), se3Exp(se3Adjoint(T) * small) * T), 1e-11) << xi.transpose();
  }
}

TEST(Se3Test, RightJacobianIsTheDerivativeOfTheExponential) {
  constexpr double kStep = 1e-5;
  for (const Vector6d& xi : tangents()) {
    Matrix6d numeric;
    for (int i = 0; i < 6; ++i) {
      const Vector6d d = kStep * Vector6d::Unit(i);
      const SE3 inverse = se3Exp(xi).inverse();
      numeric.col(i) = (se3Log(inverse * se3Exp(xi + d)) - se3Log(inverse * se3Exp(xi - d))) / (2 * kStep);
    }
    EXPECT_LT((se3RightJacobian(xi) - numeric).norm(), 1e-8) << xi.transpose();
    EXPECT_LT((so3RightJacobian(xi.tail<3>()) - numeric.bottomRightCorner<3, 3>()).norm(), 1e-8)
        << xi.transpose();
  }
}

TEST(Se3Test, InverseJacobiansAreInverse) {
  for (const Vector6d& xi : tangents()) {
    EXPECT_LT((se3RightJacobian(xi) * se3RightJacobianInverse(xi) - Matrix6d::Identity()).norm(), 1e-7)
        << xi.transpose();
    const Eigen::Vector3d w = xi.tail<3>();
    EXPECT_LT((so3RightJacobian(w) * so3RightJacobianInverse(w) - Eigen::Matrix3d::Identity()).norm(), 1e-8)
        << xi.transpose();
  }
}

TEST(Se3Test, InterpolationFollowsAConstantTwist) {
  const SE3 a = se3Exp(tangents()[7]);
  const Vector6d twist = vec(0.4, -0.1, 0.2, 0.3, -0.5, 0.2);
  const SE3 b = a * se3Exp(twist);
  for (const double s : {-0.5, 0.0, 0.25, 1.0, 1.5})
    EXPECT_LT(distance(interpolate(a, b, s), a * se3Exp(s * twist)), 1e-12) << s;
}

TEST(Se3Test, ComposedCovarianceIsThatOfSamples) {
  const SE3 T1 = se3Exp(tangents()[8]), T2 = se3Exp(tangents()[7]);
  Vector6d sigma1, sigma2;
  sigma1 << 0.01, 0.02, 0.015, 0.004, 0.002, 0.006;
  sigma2 << 0.02, 0.01, 0.01, 0.003, 0.005, 0.002;
  std::mt19937_64 generator(7);
  std::normal_distribution<double> normal;
  const auto draw = [&](const Vector6d& sigma) {
    Vector6d v;
    for (int i = 0; i < 6; ++i) v[i] = sigma[i] * normal(generator);
    return v;
  };
  constexpr int kSamples = 40000;
  Matrix6d sampled = Matrix6d::Zero();
  for (int n = 0; n < kSamples; ++n) {
    const Vector6d d1 = draw(sigma1), d2 = draw(sigma2);
    const Vector6d error = se3Log((T1 * T2).inverse() * (T1 * se3Exp(d1) * T2 * se3Exp(d2)));
    sampled += error * error.transpose() / kSamples;
  }
  const Matrix6d cov1 = sigma1.cwiseAbs2().asDiagonal(), cov2 = sigma2.cwiseAbs2().asDiagonal();
  const Matrix6d composed = composeCovariance(cov1, T2, cov2);
  EXPECT_LT((composed - sampled).norm() / composed.norm(), 0.03);
  EXPECT_LT((composed - composed.transpose()).norm(), 1e-15);
}

TEST(Se3Test, NotFiniteIsSeen) {
  SE3 T;
  EXPECT_TRUE(T.isFinite());
  T.translation.y() = std::nan("");
  EXPECT_FALSE(T.isFinite());
}

}  // namespace
}  // namespace sgraphs
