// What the residuals of planes mean; what holds for every residual is in costs_test.cpp.
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <array>
#include <random>

#include "backend/factors/faces_cost.h"
#include "backend/factors/lateral_part.h"
#include "backend/factors/plane_up_cost.h"
#include "backend/factors/pose_plane_cost.h"
#include "backend/factors/same_height_cost.h"
#include "backend/factors/unit_vector_manifold.h"
#include "tests/backend/factors/factor_states.h"

namespace sgraphs {
namespace {

using test::Storage;
using test::stored;

double evaluateNorm(const ceres::CostFunction& cost, const std::vector<const double*>& x) {
  Eigen::VectorXd r(cost.num_residuals());
  EXPECT_TRUE(cost.Evaluate(x.data(), r.data(), nullptr));
  return r.norm();
}

// A floor 0.5 m below the body: true normal tilted by 2 mrad along u, true plane 3 cm along +z of what was
// seen. With sigmas of 1 mrad and 1 cm the residual is (2, 0, 3).
TEST(PosePlaneCostTest, ResidualIsTheErrorInStandardDeviationsWithItsSigns) {
  PlaneObservation z;
  z.normal_body = Eigen::Vector3d::UnitZ();
  z.centroid_body = Eigen::Vector3d(2, 1, -0.5);
  z.covariance = Eigen::Vector3d(1e-6, 1e-6, 1e-4).asDiagonal();
  const TangentBasis B = tangentBasis(z.normal_body);
  const PlaneState truth{UnitVectorManifold::plus(z.normal_body, {0.002, 0.0}), 0.0,
                         z.centroid_body + 0.03 * z.normal_body};
  const Storage pose = stored(SE3()), plane = stored(truth);
  const std::array<const double*, 2> x{pose.data(), plane.data()};
  Eigen::Vector3d r;
  ASSERT_TRUE(PosePlaneCost::Create(z)->Evaluate(x.data(), r.data(), nullptr));
  EXPECT_LT((r - Eigen::Vector3d(2, 0, 3)).norm(), 1e-4) << r.transpose() << " basis " << B;
}

// Observations drawn from a covariance with strong cross terms: the residuals are white, as they are only if
// signs and order of tilt and offset are those of the covariance.
TEST(PosePlaneCostTest, ResidualsOfDrawnObservationsAreWhite) {
  std::mt19937 random(31);
  std::normal_distribution<double> normal;
  const SE3 T_map_body(so3Exp({0.3, -0.5, 1.1}), {4, -2, 1});
  Eigen::Matrix3d root;
  root << 0.002, 0, 0, 0.001, 0.0015, 0, -0.008, 0.006, 0.004;
  const Storage pose = stored(T_map_body);
  constexpr int kDraws = 4000;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (int i = 0; i < kDraws; ++i) {
    PlaneObservation z;
    z.normal_body = Eigen::Vector3d(normal(random), normal(random), normal(random)).normalized();
    z.centroid_body = Eigen::Vector3d(3, 1, -1);
    z.covariance = root * root.transpose();
    const Eigen::Vector3d error = root * Eigen::Vector3d(normal(random), normal(random), normal(random));
    const Eigen::Vector3d n = (z.normal_body + tangentBasis(z.normal_body) * error.head<2>()).normalized();
    const Eigen::Vector3d through = z.centroid_body + error(2) * z.normal_body;
    const Storage plane = stored(PlaneState{T_map_body.rotation * n, 0.0, T_map_body * through});
    const std::array<const double*, 2> x{pose.data(), plane.data()};
    Eigen::Vector3d r;
    ASSERT_TRUE(PosePlaneCost::Create(z)->Evaluate(x.data(), r.data(), nullptr));
    mean += r / kDraws;
    covariance += r * r.transpose() / kDraws;
  }
  EXPECT_LT(mean.norm(), 4.0 * std::sqrt(3.0 / kDraws));
  EXPECT_LT((covariance - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff(), 0.1);
}

TEST(PosePlaneCostTest, AnotherAnchorOfTheSamePlaneDoesNotMatter) {
  PlaneObservation z;
  z.normal_body = Eigen::Vector3d(0.6, 0, 0.8);
  z.centroid_body = Eigen::Vector3d(1, 2, 3);
  z.covariance = 0.01 * Eigen::Matrix3d::Identity();
  const PlaneState plane{Eigen::Vector3d(0.5, 0.1, 0.8).normalized(), 0.2, {1, 1, 1}};
  const Storage pose = stored(SE3(so3Exp({0.1, 0.2, 0.1}), {0.3, 0, 0}));
  const Storage a = stored(plane), b = stored(plane.anchoredAt({-7, 3, 12}));
  const auto cost = PosePlaneCost::Create(z);
  EXPECT_NEAR(evaluateNorm(*cost, {pose.data(), a.data()}), evaluateNorm(*cost, {pose.data(), b.data()}),
              1e-9);
}

TEST(PosePlaneCostTest, RefusesWhatIsNoPlaneOrHasNoCovariance) {
  PlaneObservation z;
  z.covariance(2, 2) = 0.0;
  EXPECT_THROW(PosePlaneCost::Create(z), std::logic_error);
  z.covariance(2, 2) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(PosePlaneCost::Create(z), std::logic_error);
  z.covariance(2, 2) = 1.0;
  z.normal_body *= 1.1;
  EXPECT_THROW(PosePlaneCost::Create(z), std::logic_error);
}

// 1 degree off at sigma 0.5 degrees is 2, for floors and ceilings, and for the walls' own residual.
TEST(PlaneUpCostTest, ResidualIsTheAngleInStandardDeviations) {
  const double degree = M_PI / 180.0;
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  const auto level = PlaneUpCost::Create(PlaneUpCost::Kind::kLevel, 0.5 * degree);
  const auto plumb = PlaneUpCost::Create(PlaneUpCost::Kind::kPlumb, 0.5 * degree);
  for (const double azimuth : {0.0, 0.7, 2.0, 4.5}) {
    const Eigen::Quaterniond tilt = so3Exp(degree * Eigen::Vector3d(std::cos(azimuth), std::sin(azimuth), 0));
    for (const double side : {1.0, -1.0}) {
      const Storage plane = stored(PlaneState{side * (tilt * up), 3.0, {1, 2, 3}});
      EXPECT_NEAR(evaluateNorm(*level, {plane.data(), up.data()}), 2.0, 1e-3);
    }
    const Storage wall =
        stored(PlaneState{tilt * Eigen::Vector3d(-std::sin(azimuth), std::cos(azimuth), 0), 3.0, {1, 2, 3}});
    EXPECT_NEAR(evaluateNorm(*plumb, {wall.data(), up.data()}), 2.0, 1e-3);
  }
  EXPECT_THROW(PlaneUpCost::Create(PlaneUpCost::Kind::kLevel, 0.0), std::logic_error);
}

// No jump and no kink of the squared residual where tangentBasis jumps, at normals through the horizon.
TEST(PlaneUpCostTest, CostIsSmoothWhereTheBasisJumps) {
  const auto level = PlaneUpCost::Create(PlaneUpCost::Kind::kLevel, 0.1);
  const Eigen::Vector3d up = Eigen::Vector3d(0.8, 0.3, 0.4).normalized();
  const auto gradient = [&](double z, double* chi2) {
    const Storage plane = stored(PlaneState{Eigen::Vector3d(0.9, 0.2, z).normalized(), 0.0, {}});
    Eigen::Vector2d r;
    Eigen::Matrix<double, 2, 7, Eigen::RowMajor> J;
    const std::array<const double*, 2> x{plane.data(), up.data()};
    std::array<double*, 2> jacobians{J.data(), nullptr};
    EXPECT_TRUE(level->Evaluate(x.data(), r.data(), jacobians.data()));
    *chi2 = r.squaredNorm();
    return Eigen::Vector3d((r.transpose() * J).head<3>());
  };
  double above = 0, below = 0;
  const Eigen::Vector3d g_above = gradient(1e-9, &above), g_below = gradient(-1e-9, &below);
  EXPECT_GT(above, 1.0);
  EXPECT_NEAR(above, below, 1e-6);
  EXPECT_LT((g_above - g_below).norm(), 1e-5 * g_above.norm());
}

TEST(FacesCostTest, ThicknessIsFreeAndTheAngleCounts) {
  const auto cost = FacesCost::Create(0.01);
  const Eigen::Vector3d n(0.6, 0.8, 0);
  const Storage a = stored(PlaneState{n, 0.1, {1, 2, 0}});
  for (const double thickness : {0.05, 0.3, 1.0}) {
    const Storage b = stored(PlaneState{-n, 0.0, Eigen::Vector3d(1, 2, 1) - thickness * n});
    EXPECT_NEAR(evaluateNorm(*cost, {a.data(), b.data()}), 0.0, 1e-12);
  }
  const Storage turned = stored(PlaneState{-(so3Exp({0, 0, 0.02}) * n), 0.0, {}});
  EXPECT_NEAR(evaluateNorm(*cost, {a.data(), turned.data()}), 2.0, 1e-3);
  EXPECT_THROW(FacesCost::Create(-1.0), std::logic_error);
}

// Two floors 20 m apart, one 4 cm higher: 2 at sigma 2 cm. Where along its floor an anchor lies is no
// matter, and neither is the side the normals show to.
TEST(SameHeightCostTest, HeightsAreComparedAlongUp) {
  const auto cost = SameHeightCost::Create(0.02);
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  const Storage a = stored(PlaneState{up, 0.0, {0, 0, 1.0}});
  const PlaneState b{-up, 0.0, {20, 5, 1.04}};
  const Storage here = stored(b), there = stored(b.anchoredAt({-3, 8, 1.7}));
  EXPECT_NEAR(evaluateNorm(*cost, {a.data(), here.data(), up.data()}), 2.0, 1e-9);
  EXPECT_NEAR(evaluateNorm(*cost, {a.data(), there.data(), up.data()}), 2.0, 1e-9);
  EXPECT_THROW(SameHeightCost::Create(0.0), std::logic_error);
}

}  // namespace
}  // namespace sgraphs
