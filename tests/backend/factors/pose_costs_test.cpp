// What the residuals of poses mean; what holds for every residual is in costs_test.cpp.
#include <gtest/gtest.h>

#include <array>
#include <limits>

#include "backend/factors/relative_pose_cost.h"
#include "backend/factors/up_cost.h"
#include "tests/backend/factors/factor_states.h"

namespace sgraphs {
namespace {

using test::Storage;
using test::stored;

// 3 cm at sigma 1 cm and 2 mrad at sigma 1 mrad: chi2 is 9 + 4.
TEST(RelativePoseCostTest, ResidualIsInStandardDeviations) {
  Vector6d sigma;
  sigma << 0.01, 0.01, 0.01, 0.001, 0.001, 0.001;
  const auto cost = RelativePoseCost::Create(SE3(), sigma.cwiseAbs2().asDiagonal());
  const Storage a = stored(SE3());
  const Storage b = stored({so3Exp({0, 0, 0.002}), {0.03, 0, 0}});
  const std::array<const double*, 2> x{a.data(), b.data()};
  Vector6d r;
  ASSERT_TRUE(cost->Evaluate(x.data(), r.data(), nullptr));
  EXPECT_NEAR(r.squaredNorm(), 13.0, 1e-3);
  EXPECT_NEAR(r(5), 2.0, 1e-9);
}

TEST(RelativePoseCostTest, RefusesACovarianceThatIsNotPositiveDefinite) {
  Matrix6d covariance = Matrix6d::Identity();
  covariance(4, 4) = -1.0;
  EXPECT_THROW(RelativePoseCost::Create(SE3(), covariance), std::logic_error);
  covariance(4, 4) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(RelativePoseCost::Create(SE3(), covariance), std::logic_error);
}

TEST(UpCostTest, TiltOfOneSigmaIsOneAndHeadingIsFree) {
  const auto cost = UpCost::Create(Eigen::Vector3d::UnitZ(), 0.01);
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  for (const double heading : {0.0, 1.0, 2.5}) {
    const Storage T = stored({so3Exp({0, 0, heading}) * so3Exp({0.01, 0, 0}), Eigen::Vector3d(4, 5, 6)});
    const std::array<const double*, 2> x{T.data(), up.data()};
    Eigen::Vector2d r;
    ASSERT_TRUE(cost->Evaluate(x.data(), r.data(), nullptr));
    EXPECT_NEAR(r.norm(), 1.0, 1e-4);
  }
}

TEST(UpCostTest, GrowsUpToNinetyDegrees) {
  const auto cost = UpCost::Create(Eigen::Vector3d::UnitZ(), 1.0);
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  double last = -1.0;
  for (int degrees = 0; degrees <= 90; degrees += 5) {
    const Storage T = stored({so3Exp({0, degrees * M_PI / 180.0, 0}), Eigen::Vector3d::Zero()});
    const std::array<const double*, 2> x{T.data(), up.data()};
    Eigen::Vector2d r;
    ASSERT_TRUE(cost->Evaluate(x.data(), r.data(), nullptr));
    EXPECT_GT(r.norm(), last);
    last = r.norm();
  }
  EXPECT_NEAR(last, 1.0, 1e-9);
}

TEST(UpCostTest, RefusesWhatIsNoDirectionOrHasNoSigma) {
  EXPECT_THROW(UpCost::Create(Eigen::Vector3d::Zero(), 0.01), std::logic_error);
  EXPECT_THROW(UpCost::Create(Eigen::Vector3d::UnitZ(), 0.0), std::logic_error);
}

}  // namespace
}  // namespace sgraphs
