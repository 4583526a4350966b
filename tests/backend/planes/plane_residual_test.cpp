#include "backend/planes/plane_residual.h"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "backend/planes/shared_information.h"
#include "tests/backend/planes/plane_world.h"

namespace sgraphs {
namespace {

using testing_support::Face;
using testing_support::noisy;
using testing_support::observe;
using testing_support::planeOf;

const Face kWall{{4, 1, 1.2}, Eigen::Vector3d(-1, 0.2, 0.05).normalized()};
const SE3 kPose{so3Exp({0.1, -0.2, 0.7}), {0.5, -0.3, 0.6}};

PlaneNode turned(PlaneNode plane, const Eigen::Vector3d& delta) {
  plane.normal_map = (plane.normal_map + tangentBasis(plane.normal_map) * delta.head<2>()).normalized();
  plane.offset_m += delta.z();
  return plane;
}

TEST(PlaneResidualTest, ZeroAtTruthAndJacobiansAreDerivatives) {
  const PlaneNode plane = planeOf(kWall);
  const PlaneObservation z = observe(kWall, kPose);
  const PlaneResidual at = planeResidual(z, kPose, plane);
  EXPECT_LT(at.value.norm(), 1e-12);
  constexpr double kStep = 1e-6;
  for (int i = 0; i < 6; ++i) {
    const Vector6d d = kStep * Vector6d::Unit(i);
    const Eigen::Vector3d slope = (planeResidual(z, kPose * se3Exp(d), plane).value -
                                   planeResidual(z, kPose * se3Exp(-d), plane).value) /
                                  (2 * kStep);
    EXPECT_LT((slope - at.by_pose.col(i)).norm(), 1e-7) << i;
  }
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector3d d = kStep * Eigen::Vector3d::Unit(i);
    const Eigen::Vector3d slope =
        (planeResidual(z, kPose, turned(plane, d)).value - planeResidual(z, kPose, turned(plane, -d)).value) /
        (2 * kStep);
    EXPECT_LT((slope - at.by_plane.col(i)).norm(), 1e-7) << i;
  }
}

// The truth is the observation plus an error of the stated covariance: the residual at truth has it.
TEST(PlaneResidualTest, AtTruthItHasTheStatedCovariance) {
  Eigen::Matrix3d covariance;
  covariance << 4e-6, 1e-6, 2e-6, 1e-6, 9e-6, -3e-6, 2e-6, -3e-6, 1.6e-5;
  const PlaneObservation z = observe(kWall, kPose, covariance);
  std::mt19937 random(3);
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  constexpr int kDraws = 20000;
  for (int i = 0; i < kDraws; ++i) {
    const Eigen::Vector3d e = planeResidual(noisy(z, random), kPose, planeOf(kWall)).value;
    sum += e * e.transpose() / kDraws;
  }
  EXPECT_LT((sum - covariance).norm(), 0.05 * covariance.norm()) << sum;
}

TEST(PlaneResidualTest, CovarianceMovesAlongThePlaneAndBack) {
  const PlaneNode plane = planeOf(kWall);
  const Eigen::Matrix3d covariance = Eigen::Vector3d(1e-6, 4e-6, 1e-4).asDiagonal();
  const Eigen::Vector3d far = plane.anchor_map + tangentBasis(plane.normal_map) * Eigen::Vector2d(3, -2);
  const Eigen::Matrix3d there = movedCovariance(covariance, plane.normal_map, plane.anchor_map, far);
  EXPECT_NEAR(there(2, 2), 1e-4 + 9 * 1e-6 + 4 * 4e-6, 1e-12);
  EXPECT_TRUE(movedCovariance(there, plane.normal_map, far, plane.anchor_map).isApprox(covariance, 1e-9));
}

// The axes flip where the normal's z changes sign; an ellipse in space must not.
TEST(PlaneResidualTest, ReframingKeepsTheEllipseInSpace) {
  const Eigen::Vector3d above = Eigen::Vector3d(1, 0.3, 1e-9).normalized();
  const Eigen::Vector3d below = Eigen::Vector3d(1, 0.3, -1e-9).normalized();
  const Eigen::Matrix3d covariance = Eigen::Vector3d(1e-6, 4e-6, 1e-4).asDiagonal();
  const Eigen::Matrix3d after = reframedCovariance(covariance, above, below);
  const auto inSpace = [](const Eigen::Vector3d& n, const Eigen::Matrix3d& c) {
    return Eigen::Matrix3d(tangentBasis(n) * c.topLeftCorner<2, 2>() * tangentBasis(n).transpose());
  };
  EXPECT_TRUE(inSpace(below, after).isApprox(inSpace(above, covariance), 1e-6));
  EXPECT_FALSE(after.isApprox(covariance, 1e-3)) << "the axes did flip";
}

TEST(SharedInformationTest, OnlyDirectionsThatPlanesShowGiveWay) {
  const Matrix6d covariance = 1e-4 * Matrix6d::Identity();
  EXPECT_TRUE(withoutSharedInformation(covariance, Matrix6d::Zero(), 10).isApprox(covariance, 1e-12));
  EXPECT_TRUE(
      withoutSharedInformation(covariance, 1e8 * Matrix6d::Identity(), 0).isApprox(covariance, 1e-12));
  Matrix6d planes = Matrix6d::Zero();
  planes(0, 0) = 1e8;
  const Matrix6d after = withoutSharedInformation(covariance, planes, 10);
  EXPECT_NEAR(after(0, 0), 11e-4, 1e-6);
  EXPECT_NEAR(after(1, 1), 1e-4, 1e-9);
}

TEST(SharedInformationTest, DoesNotDependOnCoordinates) {
  Matrix6d covariance = Vector6d(1e-4, 2e-4, 3e-4, 1e-6, 2e-6, 3e-6).asDiagonal(), planes = Matrix6d::Zero();
  planes(0, 0) = 2e4;
  planes(4, 4) = 1e6;
  const Matrix6d A = se3Adjoint(SE3(so3Exp({0.3, -0.2, 1.1}), {1, 2, 3}));
  const Matrix6d turned = withoutSharedInformation(A * covariance * A.transpose(),
                                                   A.inverse().transpose() * planes * A.inverse(), 7);
  EXPECT_TRUE(turned.isApprox(A * withoutSharedInformation(covariance, planes, 7) * A.transpose(), 1e-9));
}

// Six planes that know everything but the shared error must not know more than it allows together.
TEST(SharedInformationTest, SharedErrorIsNotAveragedDownByMorePlanes) {
  Vector6d sigma;
  sigma << Eigen::Vector3d::Constant(0.002), Eigen::Vector3d::Constant(0.0015);
  std::vector<PlaneObservation> planes;
  for (const Eigen::Vector3d& n :
       {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0, 1, 0), Eigen::Vector3d(0, 0, 1)})
    for (const double side : {-1.0, 1.0}) {
      Face face{-2 * side * n, side * n};
      PlaneObservation z = observe(face, SE3());
      const Eigen::Matrix<double, 3, 6> J = observationByPose(z);
      z.covariance = J * sigma.cwiseAbs2().asDiagonal() * J.transpose() + 1e-9 * Eigen::Matrix3d::Identity();
      planes.push_back(z);
    }
  const auto poseCovariance = [&] {
    Matrix6d information = Matrix6d::Zero();
    for (const PlaneObservation& z : planes) {
      const Eigen::Matrix<double, 3, 6> J = observationByPose(z);
      information += J.transpose() * z.covariance.inverse() * J;
    }
    return Matrix6d(information.inverse());
  };
  EXPECT_LT(poseCovariance()(3, 3), 0.4 * sigma(3) * sigma(3)) << "as if independent";
  keepSharedError(sigma, planes);
  for (int i = 0; i < 6; ++i)
    EXPECT_NEAR(poseCovariance()(i, i), sigma(i) * sigma(i), 0.2 * sigma(i) * sigma(i));
}

TEST(SharedInformationTest, OnePlaneKeepsItsCovariance) {
  Vector6d sigma;
  sigma << Eigen::Vector3d::Constant(0.002), Eigen::Vector3d::Constant(0.0015);
  std::vector<PlaneObservation> planes{observe(kWall, kPose)};
  const Eigen::Matrix<double, 3, 6> J = observationByPose(planes[0]);
  planes[0].covariance += J * sigma.cwiseAbs2().asDiagonal() * J.transpose();
  const Eigen::Matrix3d before = planes[0].covariance;
  keepSharedError(sigma, planes);
  EXPECT_TRUE(planes[0].covariance.isApprox(before, 1e-9));
}

}  // namespace
}  // namespace sgraphs
