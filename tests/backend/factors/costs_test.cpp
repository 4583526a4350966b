// Every residual of the graph is listed once in kResiduals; what must hold for all of them is tested for
// each.
#include <ceres/gradient_checker.h>
#include <gtest/gtest.h>

#include <functional>
#include <random>

#include "backend/factors/center_anchor_cost.h"
#include "backend/factors/center_walls_cost.h"
#include "backend/factors/faces_cost.h"
#include "backend/factors/floor_height_cost.h"
#include "backend/factors/floor_room_cost.h"
#include "backend/factors/plane_manifold.h"
#include "backend/factors/plane_up_cost.h"
#include "backend/factors/pose_manifold.h"
#include "backend/factors/pose_plane_cost.h"
#include "backend/factors/relative_pose_cost.h"
#include "backend/factors/room_shape_cost.h"
#include "backend/factors/same_height_cost.h"
#include "backend/factors/unit_vector_manifold.h"
#include "backend/factors/up_cost.h"
#include "tests/backend/factors/factor_states.h"

namespace sgraphs {
namespace {

using test::gaussian;
using test::randomPose;

enum class Block { kPose, kPlane, kUnitVector, kCenter, kHeight };

// Maps that a residual does not tell apart: all, those whose z axis is up, or those with the same axes.
enum class Maps { kAny, kLevel, kShifted };

using States = std::vector<Eigen::VectorXd>;

Eigen::Vector3d randomDirection(std::mt19937& random) {
  return gaussian(3, 1.0, random).normalized();
}

Eigen::VectorXd stateOf(const PlaneState& plane) {
  Eigen::VectorXd x(7);
  PlaneManifold::store(plane, x.data());
  return x;
}

Eigen::VectorXd randomPlane(const Eigen::Vector3d& normal, std::mt19937& random) {
  return stateOf(PlaneState{normal, gaussian(1, 0.5, random)(0), gaussian(3, 3.0, random)});
}

Matrix6d randomCovariance(std::mt19937& random) {
  const Eigen::VectorXd entries = gaussian(36, 0.1, random);
  const Eigen::Map<const Matrix6d> A(entries.data());
  return A * A.transpose() + 0.01 * Matrix6d::Identity();
}

struct Residual {
  std::string name;
  std::vector<Block> blocks;
  std::function<States(std::mt19937&)> sampleStates;
  // The cost whose measurement is exact at `truth`, its standard deviations scaled by `sigma_scale`.
  std::function<std::unique_ptr<ceres::CostFunction>(const States& truth, double sigma_scale)> create;
  // Of the states about the truth, so that the error stays where the residual is regular.
  double perturbation;
  // Its coordinates turn with the map's axes: only its length has a meaning.
  bool length_only = false;
  Maps maps = Maps::kAny;
};

// The plane of x[1] as the pose of x[0] sees it, at the point of it below the body's origin and aside.
PlaneObservation observe(const States& x, const Eigen::Matrix3d& covariance) {
  const SE3 T_map_body = PoseManifold::load(x[0].data());
  const PlaneState plane = PlaneManifold::load(x[1].data());
  const Eigen::Vector3d aside =
      T_map_body.translation + tangentBasis(plane.normal) * Eigen::Vector2d(1.5, -0.7);
  PlaneObservation z;
  z.normal_body = T_map_body.rotation.conjugate() * plane.normal;
  z.centroid_body = T_map_body.inverse() * (aside - plane.distance(aside) * plane.normal);
  z.covariance = covariance;
  return z;
}

// A wall, plumb, facing this way.
Eigen::VectorXd randomWall(double heading_rad, std::mt19937& random) {
  return randomPlane({std::cos(heading_rad), std::sin(heading_rad), 0}, random);
}

// Halfway between two walls that are 20 degrees from parallel.
States centerBetweenWalls(std::mt19937& random) {
  const double heading = gaussian(1, 2.0, random)(0);
  const Eigen::Vector2d center = gaussian(2, 3.0, random);
  States x{center, randomWall(heading, random), randomWall(heading + M_PI + 0.35, random)};
  for (size_t i : {1, 2}) {
    const PlaneState plane = PlaneManifold::load(x[i].data());
    x[i](3) += 1.7 - plane.distance({center.x(), center.y(), 0.4});
  }
  return x;
}

void addRoomResiduals(std::vector<Residual>& all) {
  all.push_back({"CenterWalls",
                 {Block::kCenter, Block::kPlane, Block::kPlane},
                 centerBetweenWalls,
                 [](const States&, double scale) { return CenterWallsCost::Create(0.4, 0.02 * scale); },
                 0.3,
                 false,
                 Maps::kLevel});
  all.push_back({"CenterAnchor",
                 {Block::kCenter, Block::kPose},
                 [](std::mt19937& random) {
                   return States{gaussian(2, 3.0, random), randomPose(random)};
                 },
                 [](const States& x, double scale) {
                   const SE3 T_body_map = PoseManifold::load(x[1].data()).inverse();
                   return CenterAnchorCost::Create(T_body_map * Eigen::Vector3d(x[0](0), x[0](1), 0.7),
                                                   T_body_map.rotation * Eigen::Vector3d(-0.8, 0.6, 0),
                                                   0.05 * scale);
                 },
                 0.4,
                 false,
                 Maps::kLevel});
  for (const bool square : {false, true})
    all.push_back({square ? "Square" : "Parallel",
                   {Block::kPlane, Block::kPlane},
                   [square](std::mt19937& random) {
                     const double heading = gaussian(1, 2.0, random)(0);
                     const double other = heading + (square ? M_PI / 2 : M_PI);
                     return States{randomWall(heading, random), randomWall(other, random)};
                   },
                   [square](const States&, double scale) {
                     const auto kind = square ? RoomShapeCost::Kind::kSquare : RoomShapeCost::Kind::kParallel;
                     return RoomShapeCost::Create(kind, 0.005 * scale);
                   },
                   0.3,
                   false,
                   Maps::kLevel});
  all.push_back({"FloorHeight",
                 {Block::kHeight, Block::kPlane},
                 [](std::mt19937& random) {
                   const Eigen::VectorXd plane = randomPlane(Eigen::Vector3d::UnitZ(), random);
                   return States{Eigen::VectorXd::Constant(1, plane(6) - plane(3)), plane};
                 },
                 [](const States&, double scale) { return FloorHeightCost::Create(0.01 * scale); },
                 0.35,
                 false,
                 Maps::kLevel});
  all.push_back({"FloorRoom",
                 {Block::kCenter, Block::kCenter},
                 [](std::mt19937& random) {
                   return States{gaussian(2, 5.0, random), gaussian(2, 5.0, random)};
                 },
                 [](const States& x, double scale) { return FloorRoomCost::Create(x[1] - x[0], 8 * scale); },
                 20,
                 false,
                 Maps::kShifted});
}

std::vector<Residual> residuals() {
  std::vector<Residual> all;
  all.push_back({"RelativePose",
                 {Block::kPose, Block::kPose},
                 [](std::mt19937& random) {
                   return States{randomPose(random), randomPose(random)};
                 },
                 [](const States& x, double scale) {
                   std::mt19937 random(11);
                   const SE3 Z = PoseManifold::load(x[0].data()).inverse() * PoseManifold::load(x[1].data());
                   return RelativePoseCost::Create(Z, scale * scale * randomCovariance(random));
                 },
                 0.6});
  all.push_back({"Up",
                 {Block::kPose, Block::kUnitVector},
                 [](std::mt19937& random) {
                   return States{randomPose(random), randomDirection(random)};
                 },
                 [](const States& x, double scale) {
                   const Eigen::Vector3d up = x[1];
                   const Eigen::Vector3d up_body = PoseManifold::load(x[0].data()).rotation.conjugate() * up;
                   return UpCost::Create(up_body.normalized(), 0.02 * scale);
                 },
                 0.5});
  all.push_back({"PosePlane",
                 {Block::kPose, Block::kPlane},
                 [](std::mt19937& random) {
                   return States{randomPose(random), randomPlane(randomDirection(random), random)};
                 },
                 [](const States& x, double scale) {
                   std::mt19937 random(12);
                   const Eigen::Matrix3d covariance = randomCovariance(random).topLeftCorner<3, 3>();
                   return PosePlaneCost::Create(observe(x, scale * scale * covariance));
                 },
                 0.4});
  all.push_back({"Level",
                 {Block::kPlane, Block::kUnitVector},
                 [](std::mt19937& random) {
                   const Eigen::Vector3d up = randomDirection(random);
                   return States{randomPlane(random() % 2 ? up : -up, random), up};
                 },
                 [](const States&, double scale) {
                   return PlaneUpCost::Create(PlaneUpCost::Kind::kLevel, 0.01 * scale);
                 },
                 0.4,
                 true});
  all.push_back({"Plumb",
                 {Block::kPlane, Block::kUnitVector},
                 [](std::mt19937& random) {
                   const Eigen::Vector3d up = randomDirection(random);
                   return States{randomPlane(tangentBasis(up).col(random() % 2), random), up};
                 },
                 [](const States&, double scale) {
                   return PlaneUpCost::Create(PlaneUpCost::Kind::kPlumb, 0.01 * scale);
                 },
                 0.4});
  all.push_back({"Faces",
                 {Block::kPlane, Block::kPlane},
                 [](std::mt19937& random) {
                   const Eigen::Vector3d normal = randomDirection(random);
                   return States{randomPlane(normal, random), randomPlane(-normal, random)};
                 },
                 [](const States&, double scale) { return FacesCost::Create(0.01 * scale); },
                 0.4,
                 true});
  all.push_back({"SameHeight",
                 {Block::kPlane, Block::kPlane, Block::kUnitVector},
                 [](std::mt19937& random) {
                   const Eigen::Vector3d up = randomDirection(random);
                   const Eigen::VectorXd a = randomPlane(up, random);
                   const double height = up.dot(Eigen::Vector3d(a.data() + 4) - a(3) * up);
                   const Eigen::Vector3d anchor = gaussian(3, 3.0, random);
                   return States{a, stateOf(PlaneState{-up, height - up.dot(anchor), anchor}), up};
                 },
                 [](const States&, double scale) { return SameHeightCost::Create(0.02 * scale); },
                 0.4});
  addRoomResiduals(all);
  return all;
}

class CostTest : public testing::TestWithParam<Residual> {
 protected:
  const ceres::Manifold& manifold(size_t block) const {
    if (GetParam().blocks[block] == Block::kPose) return pose_;
    if (GetParam().blocks[block] == Block::kPlane) return plane_;
    if (GetParam().blocks[block] == Block::kCenter) return center_;
    if (GetParam().blocks[block] == Block::kHeight) return height_;
    return unit_vector_;
  }

  States perturbed(const States& x, std::mt19937& random) const {
    States y = x;
    for (size_t i = 0; i < x.size(); ++i) {
      const Eigen::VectorXd delta = gaussian(manifold(i).TangentSize(), GetParam().perturbation, random);
      manifold(i).Plus(x[i].data(), delta.data(), y[i].data());
    }
    return y;
  }

  static Eigen::VectorXd evaluate(const ceres::CostFunction& cost, const States& x) {
    std::vector<const double*> blocks;
    for (const Eigen::VectorXd& block : x) blocks.push_back(block.data());
    Eigen::VectorXd r(cost.num_residuals());
    EXPECT_TRUE(cost.Evaluate(blocks.data(), r.data(), nullptr));
    return r;
  }

  // The same states seen from another map frame.
  States inOtherMap(const States& x, const SE3& T_other_map) const {
    States y = x;
    for (size_t i = 0; i < x.size(); ++i) {
      if (GetParam().blocks[i] == Block::kPose)
        PoseManifold::store(T_other_map * PoseManifold::load(x[i].data()), y[i].data());
      else if (GetParam().blocks[i] == Block::kPlane)
        y[i] = inOtherMap(PlaneManifold::load(x[i].data()), T_other_map);
      else if (GetParam().blocks[i] == Block::kCenter)
        y[i] = (T_other_map * Eigen::Vector3d(x[i](0), x[i](1), 0)).head<2>();
      else if (GetParam().blocks[i] == Block::kUnitVector)
        y[i] = T_other_map.rotation * Eigen::Vector3d(x[i]);
    }
    return y;
  }

  static Eigen::VectorXd inOtherMap(const PlaneState& plane, const SE3& T_other_map) {
    return stateOf(
        PlaneState{T_other_map.rotation * plane.normal, plane.offset_m, T_other_map * plane.anchor});
  }

  PoseManifold pose_;
  PlaneManifold plane_;
  UnitVectorManifold unit_vector_;
  ceres::EuclideanManifold<2> center_;
  ceres::EuclideanManifold<1> height_;
};

TEST_P(CostTest, ZeroAtTruth) {
  std::mt19937 random(21);
  for (int trial = 0; trial < 5; ++trial) {
    const States truth = GetParam().sampleStates(random);
    EXPECT_LT(evaluate(*GetParam().create(truth, 1.0), truth).norm(), 1e-9);
  }
}

TEST_P(CostTest, AnalyticJacobianMatchesNumericAtPerturbedStates) {
  std::mt19937 random(22);
  std::vector<const ceres::Manifold*> manifolds;
  for (size_t i = 0; i < GetParam().blocks.size(); ++i) manifolds.push_back(&manifold(i));
  ceres::NumericDiffOptions options;
  // Ceres' first step of 1 % could reach over the horizon, where tangentBasis jumps.
  options.ridders_relative_initial_step_size = 1e-3;
  for (int trial = 0; trial < 8; ++trial) {
    const States truth = GetParam().sampleStates(random);
    const std::unique_ptr<ceres::CostFunction> cost = GetParam().create(truth, 1.0);
    const States x = perturbed(truth, random);
    ASSERT_GT(evaluate(*cost, x).norm(), 0.1) << "the state is trivial";
    std::vector<const double*> blocks;
    for (const Eigen::VectorXd& block : x) blocks.push_back(block.data());
    const ceres::GradientChecker checker(cost.get(), &manifolds, options);
    ceres::GradientChecker::ProbeResults results;
    EXPECT_TRUE(checker.Probe(blocks.data(), 1e-6, &results)) << results.error_log;
  }
}

TEST_P(CostTest, DoesNotChangeWithTheMapFrame) {
  std::mt19937 random(23);
  for (int trial = 0; trial < 5; ++trial) {
    const States truth = GetParam().sampleStates(random);
    const std::unique_ptr<ceres::CostFunction> cost = GetParam().create(truth, 1.0);
    const States x = perturbed(truth, random);
    const Eigen::VectorXd other = randomPose(random);
    SE3 T_other_map = PoseManifold::load(other.data());
    if (GetParam().maps != Maps::kAny) {
      const double turn = GetParam().maps == Maps::kLevel ? 1.0 + trial : 0.0;
      T_other_map = SE3(so3Exp({0, 0, turn}), {other(0), other(1), 0});
    }
    const Eigen::VectorXd r = evaluate(*cost, x);
    const Eigen::VectorXd r_other = evaluate(*cost, inOtherMap(x, T_other_map));
    const double difference = GetParam().length_only ? r_other.norm() - r.norm() : (r_other - r).norm();
    EXPECT_LT(std::abs(difference), 1e-9 * (1.0 + r.norm()));
  }
}

TEST_P(CostTest, HalfTheSigmaIsTwiceTheResidual) {
  std::mt19937 random(24);
  const States truth = GetParam().sampleStates(random);
  const States x = perturbed(truth, random);
  const Eigen::VectorXd r = evaluate(*GetParam().create(truth, 1.0), x);
  EXPECT_LT((evaluate(*GetParam().create(truth, 0.5), x) - 2.0 * r).norm(), 1e-9 * r.norm());
}

INSTANTIATE_TEST_SUITE_P(Residuals, CostTest, testing::ValuesIn(residuals()),
                         [](const auto& param_info) { return param_info.param.name; });

}  // namespace
}  // namespace sgraphs
