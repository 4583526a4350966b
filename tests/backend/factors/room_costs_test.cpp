// What the residuals of rooms and storeys mean; what holds for every residual is in costs_test.cpp.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <array>
#include <vector>

#include "backend/factors/center_anchor_cost.h"
#include "backend/factors/center_walls_cost.h"
#include "backend/factors/floor_height_cost.h"
#include "backend/factors/floor_room_cost.h"
#include "backend/factors/pose_manifold.h"
#include "backend/factors/room_shape_cost.h"
#include "tests/backend/factors/factor_states.h"

namespace sgraphs {
namespace {

using test::Storage;
using test::stored;

double evaluate(const ceres::CostFunction& cost, const std::vector<const double*>& x) {
  Eigen::VectorXd r(cost.num_residuals());
  EXPECT_TRUE(cost.Evaluate(x.data(), r.data(), nullptr));
  return r.size() == 1 ? r(0) : r.norm();
}

PlaneState wall(double heading_rad, const Eigen::Vector3d& through) {
  return {{std::cos(heading_rad), std::sin(heading_rad), 0}, 0.0, through};
}

// 4 cm off the middle of a room 6 m wide: 8 cm nearer to one wall than to the other, at sigma 2 cm.
TEST(CenterWallsCostTest, OffTheMiddleCountsTwice) {
  const auto cost = CenterWallsCost::Create(0.5, 0.02);
  const Storage a = stored(wall(0, {-3, 5, 0})), b = stored(wall(M_PI, {3, -7, 2}));
  const Eigen::Vector2d off(0.04, 2.0);
  EXPECT_NEAR(evaluate(*cost, {off.data(), a.data(), b.data()}), 4.0, 1e-9);
}

// Mistake 4 of earlier systems: the mid-plane of a corridor passes through the map's origin. And the width
// of the corridor is no matter, nor are walls at 45 degrees.
TEST(CenterWallsCostTest, AMidplaneThroughTheOriginIsRegular) {
  const auto cost = CenterWallsCost::Create(0.0, 0.02);
  for (const double heading : {0.0, M_PI / 4, 2.0}) {
    const Eigen::Vector3d n(std::cos(heading), std::sin(heading), 0);
    const Storage a = stored(wall(heading, -1.2 * n)), b = stored(wall(heading + M_PI, 1.2 * n));
    const Eigen::Vector2d center(-3 * n.y(), 3 * n.x());
    std::array<double, 2> by_center{};
    std::array<double*, 3> jacobians{by_center.data(), nullptr, nullptr};
    const std::array<const double*, 3> x{center.data(), a.data(), b.data()};
    double r = 1;
    ASSERT_TRUE(cost->Evaluate(x.data(), &r, jacobians.data()));
    EXPECT_NEAR(r, 0.0, 1e-9);
    EXPECT_NEAR(std::hypot(by_center[0], by_center[1]), 2 / 0.02, 1e-6);
  }
}

// The walls of a room need not be parallel: the middle is where both are equally far.
TEST(CenterWallsCostTest, TheMiddleOfATrapezoidIsEquallyFarFromBothWalls) {
  const auto cost = CenterWallsCost::Create(0.0, 0.02);
  const PlaneState a = wall(0.2, {-3, 0, 0}), b = wall(M_PI - 0.1, {2, 0, 0});
  const Storage x_a = stored(a), x_b = stored(b);
  double low = -3, high = 2;
  for (int i = 0; i < 60; ++i) {
    const Eigen::Vector2d center((low + high) / 2, 1.0);
    (evaluate(*cost, {center.data(), x_a.data(), x_b.data()}) < 0 ? low : high) = center.x();
  }
  EXPECT_NEAR(a.distance({low, 1.0, 0}), b.distance({low, 1.0, 0}), 1e-9);
}

TEST(CenterAnchorCostTest, CountsAlongItsDirectionOnly) {
  Storage pose{};
  PoseManifold::store(SE3(so3Exp({0, 0, M_PI / 2}), {5, 0, 0.6}), pose.data());
  // Body x is map y; the centre was seen 2 m ahead, at (5, 2) in map.
  const auto cost = CenterAnchorCost::Create({2, 0, 0}, {1, 0, 0}, 0.5);
  const Eigen::Vector2d beside(9.0, 2.0), ahead(5.0, 3.0);
  EXPECT_NEAR(evaluate(*cost, {beside.data(), pose.data()}), 0.0, 1e-9);
  EXPECT_NEAR(evaluate(*cost, {ahead.data(), pose.data()}), 2.0, 1e-9);
}

TEST(RoomShapeCostTest, IsTheDepartureInStandardDeviationsAndPlacesAreFree) {
  const auto parallel = RoomShapeCost::Create(RoomShapeCost::Kind::kParallel, 0.005);
  const auto square = RoomShapeCost::Create(RoomShapeCost::Kind::kSquare, 0.005);
  for (const double x : {1.0, 7.0}) {
    const Storage a = stored(wall(0.7, {x, 2, 0}));
    const Storage opposite = stored(wall(0.7 + M_PI + 0.01, {-x, 3, 1}));
    const Storage across = stored(wall(0.7 + M_PI / 2 - 0.01, {x, -x, 1}));
    EXPECT_NEAR(std::abs(evaluate(*parallel, {a.data(), opposite.data()})), 2.0, 1e-3);
    EXPECT_NEAR(std::abs(evaluate(*square, {a.data(), across.data()})), 2.0, 1e-3);
  }
}

// Out of plumb is no matter of the room's shape: in second order only.
TEST(RoomShapeCostTest, AWallOutOfPlumbIsNotOutOfShape) {
  const auto parallel = RoomShapeCost::Create(RoomShapeCost::Kind::kParallel, 0.005);
  const Storage a = stored(wall(0, {0, 0, 0}));
  const PlaneState leaning{so3Exp({0, 0.01, 0}) * Eigen::Vector3d(-1, 0, 0), 0.0, {4, 0, 0}};
  const Storage b = stored(leaning);
  EXPECT_NEAR(evaluate(*parallel, {a.data(), b.data()}), 0.0, 1e-3);
}

TEST(FloorHeightCostTest, IsHowFarTheFloorIsFromItsPlane) {
  const auto cost = FloorHeightCost::Create(0.01);
  const Storage plane = stored(PlaneState{Eigen::Vector3d::UnitZ(), -0.2, {30, 5, 2.8}});  // at 3.0
  const double z = 3.03;
  EXPECT_NEAR(evaluate(*cost, {&z, plane.data()}), 3.0, 1e-9);
}

TEST(FloorRoomCostTest, IsAWeakTieOfTheStoreysSize) {
  const auto cost = FloorRoomCost::Create({3, 4}, 16);
  const Eigen::Vector2d floor(1, 1), room(4.3, 5.4);
  EXPECT_NEAR(evaluate(*cost, {floor.data(), room.data()}), 0.5 / 16, 1e-9);
}

TEST(RoomCostsTest, RefuseWhatIsNotFiniteOrHasNoSigma) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(CenterWallsCost::Create(nan, 0.02), std::logic_error);
  EXPECT_THROW(CenterWallsCost::Create(0, 0), std::logic_error);
  EXPECT_THROW(CenterAnchorCost::Create({nan, 0, 0}, {1, 0, 0}, 1), std::logic_error);
  EXPECT_THROW(CenterAnchorCost::Create({0, 0, 0}, {2, 0, 0}, 1), std::logic_error);
  EXPECT_THROW(RoomShapeCost::Create(RoomShapeCost::Kind::kSquare, -1), std::logic_error);
  EXPECT_THROW(FloorHeightCost::Create(0), std::logic_error);
  EXPECT_THROW(FloorRoomCost::Create({nan, 0}, 1), std::logic_error);
}

}  // namespace
}  // namespace sgraphs
