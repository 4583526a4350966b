#include <ceres/manifold_test_utils.h>
#include <ceres/sphere_manifold.h>
#include <gtest/gtest.h>

#include <random>

#include "backend/factors/plane_manifold.h"
#include "backend/factors/pose_manifold.h"
#include "backend/factors/unit_vector_manifold.h"
#include "tests/backend/factors/factor_states.h"

namespace sgraphs {
namespace {

using test::gaussian;
using test::randomPose;

constexpr double kTolerance = 1e-9;
constexpr int kTrials = 20;

Eigen::VectorXd randomPlane(std::mt19937& random) {
  Eigen::VectorXd x = gaussian(PlaneManifold::kAmbientSize, 2.0, random);
  x.head<3>().normalize();
  return x;
}

// Ceres' own list of what makes a manifold, at random points and steps.
template <typename Manifold>
void expectInvariants(const std::function<Eigen::VectorXd(std::mt19937&)>& sample) {
  using namespace ceres;  // the macro's matchers
  std::mt19937 random(1);
  const Manifold manifold;
  for (int trial = 0; trial < kTrials; ++trial) {
    const ceres::Vector x = sample(random);
    const ceres::Vector delta = gaussian(manifold.TangentSize(), 0.5, random);
    ceres::Vector y(manifold.AmbientSize());
    const ceres::Vector to_y = gaussian(manifold.TangentSize(), 0.7, random);
    manifold.Plus(x.data(), to_y.data(), y.data());
    EXPECT_THAT_MANIFOLD_INVARIANTS_HOLD(manifold, x, delta, y, kTolerance);
  }
}

TEST(PoseManifoldTest, InvariantsHold) {
  expectInvariants<PoseManifold>(randomPose);
}

TEST(UnitVectorManifoldTest, InvariantsHold) {
  expectInvariants<UnitVectorManifold>(
      [](std::mt19937& random) { return gaussian(3, 1.0, random).normalized(); });
}

TEST(PlaneManifoldTest, InvariantsHold) {
  expectInvariants<PlaneManifold>(randomPlane);
}

TEST(PoseManifoldTest, PlusIsTheRightPerturbationOfSe3) {
  std::mt19937 random(2);
  for (int trial = 0; trial < kTrials; ++trial) {
    const Eigen::VectorXd x = randomPose(random);
    const Vector6d delta = gaussian(6, 0.6, random);
    std::array<double, 7> y{};
    PoseManifold().Plus(x.data(), delta.data(), y.data());
    const SE3 expected = PoseManifold::load(x.data()) * se3Exp(delta);
    EXPECT_LT(se3Log(expected.inverse() * PoseManifold::load(y.data())).norm(), 1e-12);
  }
}

TEST(PoseManifoldTest, HalfATurnSignOfTheQuaternionDoesNotMatter) {
  std::mt19937 random(3);
  const Eigen::VectorXd x = randomPose(random);
  Eigen::VectorXd y = x;
  y.tail<4>() *= -1.0;
  Vector6d difference;
  PoseManifold().Minus(y.data(), x.data(), difference.data());
  EXPECT_LT(difference.norm(), 1e-12);
}

// The angle turned by a tangent step of 0.3 is 0.3 rad. Ceres 2.1's sphere turns by another angle for the
// same step: a sigma in radians would not mean radians there.
TEST(UnitVectorManifoldTest, TangentIsInRadiansUnlikeThatOfCeres) {
  const Eigen::Vector3d n = Eigen::Vector3d(1, -2, 0.5).normalized();
  const Eigen::Vector2d delta(0.3 * std::cos(1.0), 0.3 * std::sin(1.0));
  const auto angleTurned = [&](const ceres::Manifold& manifold) {
    Eigen::Vector3d turned;
    manifold.Plus(n.data(), delta.data(), turned.data());
    return std::atan2(n.cross(turned).norm(), n.dot(turned));
  };
  EXPECT_NEAR(angleTurned(UnitVectorManifold()), 0.3, 1e-12);
  EXPECT_GT(std::abs(angleTurned(ceres::SphereManifold<3>()) - 0.3), 0.1);
}

TEST(PlaneManifoldTest, TiltIsInRadiansAndOffsetInMetres) {
  std::mt19937 random(4);
  const Eigen::VectorXd x = randomPlane(random);
  const Eigen::Vector3d delta(0.03, -0.04, 0.2);
  Eigen::VectorXd y(7);
  PlaneManifold().Plus(x.data(), delta.data(), y.data());
  EXPECT_NEAR(std::acos(x.head<3>().dot(y.head<3>())), 0.05, 1e-9);
  EXPECT_NEAR(y(3) - x(3), 0.2, 1e-12);
  EXPECT_EQ(y.tail<3>(), x.tail<3>()) << "the anchor stays";
}

TEST(PlaneStateTest, AnotherAnchorIsTheSamePlane) {
  std::mt19937 random(6);
  const Eigen::VectorXd x = randomPlane(random);
  const PlaneState plane = PlaneManifold::load(x.data());
  const Eigen::Vector3d p = gaussian(3, 5.0, random), q = gaussian(3, 5.0, random);
  const PlaneState moved = plane.anchoredAt(p);
  EXPECT_EQ(moved.anchor, p);
  EXPECT_NEAR(moved.distance(q), plane.distance(q), 1e-12);
}

// The covariance of a plane about another anchor is that of the offset there: by differences of Plus.
TEST(PlaneStateTest, CovarianceMovesWithTheAnchor) {
  std::mt19937 random(7);
  const Eigen::VectorXd x = randomPlane(random);
  const PlaneState plane = PlaneManifold::load(x.data());
  const Eigen::Vector3d p = gaussian(3, 5.0, random);
  Eigen::Matrix3d J;
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector3d delta = 1e-6 * Eigen::Vector3d::Unit(i);
    Eigen::VectorXd y(7), moved(7), reference(7);
    PlaneManifold().Plus(x.data(), delta.data(), y.data());
    PlaneManifold::store(PlaneManifold::load(y.data()).anchoredAt(p), moved.data());
    PlaneManifold::store(plane.anchoredAt(p), reference.data());
    Eigen::Vector3d difference;
    PlaneManifold().Minus(moved.data(), reference.data(), difference.data());
    J.col(i) = difference / 1e-6;
  }
  const Eigen::Matrix3d root = Eigen::Map<const Eigen::Matrix3d>(gaussian(9, 0.1, random).eval().data());
  const Eigen::Matrix3d covariance = root * root.transpose();
  const Eigen::Matrix3d expected = J * covariance * J.transpose();
  EXPECT_LT((movedCovariance(covariance, plane.normal, plane.anchor, p) - expected).norm(),
            1e-5 * expected.norm());
}

TEST(UnitVectorManifoldTest, OppositeDirectionIsHalfATurnAway) {
  const Eigen::Vector3d n = Eigen::Vector3d(0.2, 0.3, -0.9).normalized();
  const Eigen::Vector2d delta = UnitVectorManifold::minus(-n, n);
  EXPECT_NEAR(delta.norm(), M_PI, 1e-9);
  EXPECT_LT((UnitVectorManifold::plus(n, delta) + n).norm(), 1e-9);
}

TEST(TangentBasisTest, IsOrthonormalAndRightHandedEverywhere) {
  std::mt19937 random(5);
  for (int trial = 0; trial < 200; ++trial) {
    Eigen::Vector3d n = gaussian(3, 1.0, random).normalized();
    if (trial < 6) n = (trial % 2 ? -1.0 : 1.0) * Eigen::Vector3d::Unit(trial / 2);
    const TangentBasis B = tangentBasis(n);
    EXPECT_LT((B.transpose() * B - Eigen::Matrix2d::Identity()).norm(), 1e-12);
    EXPECT_LT((B.col(0).cross(B.col(1)) - n).norm(), 1e-12);
  }
}

}  // namespace
}  // namespace sgraphs
