#include "tests/backend/solver/plane_world.h"

#include <ceres/problem.h>
#include <ceres/solver.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <random>

#include "backend/factors/faces_cost.h"
#include "backend/factors/plane_manifold.h"
#include "backend/factors/plane_up_cost.h"
#include "backend/factors/pose_manifold.h"
#include "backend/factors/pose_plane_cost.h"
#include "backend/factors/relative_pose_cost.h"
#include "backend/factors/same_height_cost.h"
#include "backend/factors/unit_vector_manifold.h"
#include "backend/factors/up_cost.h"

namespace sgraphs::testing_support {
namespace {

constexpr int kFloors = 2;
constexpr double kUpSigma_rad = 0.01;
constexpr double kStructureSigma_rad = 0.005;
constexpr double kHeightSigma_m = 0.02;

template <int kSize>
Eigen::Matrix<double, kSize, 1> gaussian(std::mt19937& random) {
  std::normal_distribution<double> normal;
  Eigen::Matrix<double, kSize, 1> v;
  for (int i = 0; i < kSize; ++i) v(i) = normal(random);
  return v;
}

// A rounded way about the origin, gently rolling.
SE3 wayAt(const PlaneWorldOptions& options, double k, std::mt19937* random) {
  const double radius = options.per_lap / (2.0 * M_PI), angle = 2.0 * M_PI * k / options.per_lap;
  SE3 T(so3Exp({0, 0, angle}), {radius * std::sin(angle), radius * (1.0 - std::cos(angle)), 0});
  if (random == nullptr) return T;
  Vector6d sway = gaussian<6>(*random);
  sway.head<3>() *= 0.1;
  sway.tail<3>() *= 0.03;
  return T * se3Exp(sway);
}

// Walls beside the way, some along it, some across, every one with a face to either side.
std::vector<PlaneState> makePlanes(const PlaneWorldOptions& options, std::mt19937& random) {
  const double half = options.per_lap / 4.0;
  std::vector<PlaneState> planes{{Eigen::Vector3d::UnitZ(), 0.0, {0, half, -0.5}},
                                 {Eigen::Vector3d::UnitZ(), 0.0, {half, half, -0.5}}};
  const int walls = (options.num_planes - kFloors) / 2;
  for (int i = 0; i < walls; ++i) {
    const SE3 way = wayAt(options, (i + 0.3) * options.per_lap / walls, nullptr);
    const double turn = i % 2 ? 0.0 : M_PI / 2;
    const Eigen::Vector3d normal = way.rotation * (so3Exp({0, 0, turn}) * Eigen::Vector3d::UnitX());
    const Eigen::Vector3d aside(0.0, (i % 4 < 2 ? 2.0 : -2.0) + 0.3 * gaussian<1>(random)(0), 0.5);
    const Eigen::Vector3d centre = way * aside;
    planes.push_back({normal, 0.0, centre});
    planes.push_back({-normal, 0.0, centre - 0.15 * normal});
  }
  return planes;
}

// The planes nearest to the pose, and the floor on this side of the way.
std::vector<int> visible(const PlaneWorld& world, const Eigen::Vector3d& position) {
  std::vector<int> order(world.planes.size() - kFloors);
  std::iota(order.begin(), order.end(), kFloors);
  const auto distance = [&](int i) {
    return (world.planes[static_cast<size_t>(i)].anchor - position).norm();
  };
  std::sort(order.begin(), order.end(),
            [&](int a, int b) { return std::make_pair(distance(a), a) < std::make_pair(distance(b), b); });
  order.resize(std::min(order.size(), static_cast<size_t>(world.options.seen_per_keyframe - 1)));
  order.push_back(position.x() > 0 ? 1 : 0);
  return order;
}

PlaneObservation observe(const PlaneWorld& world, const SE3& T_map_body, const PlaneState& plane,
                         std::mt19937& random) {
  Eigen::Matrix3d root = Eigen::Vector3d(world.options.plane_sigma_rad, world.options.plane_sigma_rad,
                                         world.options.plane_sigma_m)
                             .asDiagonal();
  root(2, 0) = 0.3 * world.options.plane_sigma_m;
  PlaneObservation z;
  z.covariance = root * root.transpose();
  const Eigen::Vector3d error = root * gaussian<3>(random);
  const Eigen::Vector3d normal = T_map_body.rotation.conjugate() * plane.normal;
  // Draws the observation so that the truth is the observation and the error.
  z.normal_body = UnitVectorManifold::plus(normal, Eigen::Vector2d(-error.head<2>()));
  for (int i = 0; i < 3; ++i)
    z.normal_body = (normal - tangentBasis(z.normal_body) * error.head<2>()).normalized();
  const Eigen::Vector3d near =
      (plane.normal.z() > 0.5 ? T_map_body.translation : plane.anchor) + 0.5 * gaussian<3>(random);
  const Eigen::Vector3d centroid = near - plane.distance(near) * plane.normal;
  z.centroid_body = T_map_body.inverse() * centroid - error(2) * z.normal_body;
  return z;
}

PlaneWorldRound::Relative measure(const PlaneWorld& world, int from, int to, std::mt19937& random) {
  Vector6d sigma;
  sigma << Eigen::Vector3d::Constant(world.options.sigma_m),
      Eigen::Vector3d::Constant(world.options.sigma_rad);
  const SE3 truth = world.truth[static_cast<size_t>(from)].inverse() * world.truth[static_cast<size_t>(to)];
  return {from, truth * se3Exp(sigma.cwiseProduct(gaussian<6>(random))), sigma.cwiseAbs2().asDiagonal()};
}

}  // namespace

PlaneWorld makePlaneWorld(const PlaneWorldOptions& options) {
  std::mt19937 random(options.seed);
  PlaneWorld world;
  world.options = options;
  for (int k = 0; k < options.num_keyframes; ++k)
    world.truth.push_back(k == 0 ? SE3() : wayAt(options, k, &random));
  world.planes = makePlanes(options, random);
  for (int k = 0; k < options.num_keyframes; ++k) {
    PlaneWorldRound& round = world.rounds.emplace_back();
    const SE3& T_map_body = world.truth[static_cast<size_t>(k)];
    for (const int back : {1, 2})
      if (k >= back) round.relatives.push_back(measure(world, k - back, k, random));
    if (options.relative_loop_every > 0 && k > options.per_lap && k % options.relative_loop_every == 0)
      round.relatives.push_back(measure(world, k - options.per_lap, k, random));
    for (const int plane : visible(world, T_map_body.translation))
      round.seen.push_back(
          {plane, observe(world, T_map_body, world.planes[static_cast<size_t>(plane)], random)});
    const Eigen::Vector2d tilt = kUpSigma_rad * gaussian<2>(random);
    round.up_body =
        UnitVectorManifold::plus(T_map_body.rotation.conjugate() * Eigen::Vector3d::UnitZ(), tilt);
  }
  return world;
}

PlaneRun::PlaneRun(const PlaneWorld& world, const SolverOptions& options)
    : world_(world), solver_(options), planes_(world.planes.size(), -1) {}

void PlaneRun::add(std::function<std::unique_ptr<ceres::CostFunction>()> create, std::vector<int> states) {
  const IncrementalSolver::FactorId id = solver_.addFactor(create(), states);
  factors_.push_back({std::move(create), std::move(states), id});
}

void PlaneRun::addRound(int k) {
  const PlaneWorldRound& round = world_.rounds[static_cast<size_t>(k)];
  SE3 T_map_body;
  if (k > 0) T_map_body = solver_.pose(poseState(k - 1)) * round.relatives[0].T_from_to;
  poses_.push_back(solver_.addPose(T_map_body));
  if (k == 0) solver_.hold(poses_[0]);
  for (const PlaneWorldRound::Relative& z : round.relatives)
    add([z] { return RelativePoseCost::Create(z.T_from_to, z.covariance); },
        {poseState(z.from), poseState(k)});
  if (world_.options.structure) {
    if (up_ < 0) up_ = solver_.addSharedUnitVector(round.up_body);
    add([z = round.up_body] { return UpCost::Create(z, kUpSigma_rad); }, {poseState(k), up_});
  }
  for (const PlaneWorldRound::Seen& seen : round.seen) addObservation(k, seen);
}

void PlaneRun::addObservation(int k, const PlaneWorldRound::Seen& seen) {
  int& state = planes_[static_cast<size_t>(seen.plane)];
  const bool first = state < 0;
  if (first) {
    const SE3 T_map_body = solver_.pose(poseState(k));
    state = solver_.addPlane({T_map_body.rotation * seen.observation.normal_body, 0.0,
                              T_map_body * seen.observation.centroid_body});
  }
  add([z = seen.observation] { return PosePlaneCost::Create(z); }, {poseState(k), state});
  if (first && world_.options.structure) addStructure(seen.plane);
}

void PlaneRun::addStructure(int plane) {
  const int state = planeState(plane), other = planeState(plane ^ 1);
  const auto kind = plane < kFloors ? PlaneUpCost::Kind::kLevel : PlaneUpCost::Kind::kPlumb;
  add([kind] { return PlaneUpCost::Create(kind, kStructureSigma_rad); }, {state, up_});
  if (other < 0) return;
  if (plane < kFloors)
    add([] { return SameHeightCost::Create(kHeightSigma_m); }, {state, other, up_});
  else
    add([] { return FacesCost::Create(kStructureSigma_rad); }, {state, other});
}

PlaneRun::Batch::Batch(const PlaneRun& run) {
  std::map<int, double*> block_of_state;
  const auto put = [&](int state, int size, ceres::Manifold* manifold) {
    double* x = blocks.emplace_back().data();
    problem.AddParameterBlock(x, size, manifold);
    return block_of_state[state] = x;
  };
  for (const int state : run.poses_)
    PoseManifold::store(run.solver_.pose(state), poses[state] = put(state, 7, new PoseManifold));
  problem.SetParameterBlockConstant(poses.begin()->second);
  for (const int state : run.planes_)
    if (state >= 0)
      PlaneManifold::store(run.solver_.plane(state), planes[state] = put(state, 7, new PlaneManifold));
  if (run.up_ >= 0) {
    up = put(run.up_, 3, new UnitVectorManifold);
    Eigen::Map<Eigen::Vector3d> stored(up);
    stored = run.solver_.unitVector(run.up_);
  }
  for (const Factor& factor : run.factors_) {
    if (!run.solver_.enabled(factor.id)) continue;
    std::vector<double*> x;
    for (const int state : factor.states) x.push_back(block_of_state.at(state));
    problem.AddResidualBlock(factor.create().release(), nullptr, x);
  }
}

PlaneRun::Distance PlaneRun::distanceFromBatch() const {
  Batch batch(*this);
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  options.sparse_linear_algebra_library_type = ceres::EIGEN_SPARSE;
  options.initial_trust_region_radius = 1e10;
  options.max_num_iterations = 100;
  options.function_tolerance = 1e-15;
  options.parameter_tolerance = 1e-13;
  options.gradient_tolerance = 1e-13;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &batch.problem, &summary);

  Distance distance;
  for (const auto& [state, x] : batch.poses) {
    const SE3 optimum = PoseManifold::load(x), here = solver_.pose(state);
    distance.m = std::max(distance.m, (here.translation - optimum.translation).norm());
    distance.rad = std::max(distance.rad, here.rotation.angularDistance(optimum.rotation));
  }
  for (const auto& [state, x] : batch.planes) {
    const PlaneState optimum = PlaneManifold::load(x), here = solver_.plane(state);
    distance.plane_m = std::max(distance.plane_m, std::abs(here.offset_m - optimum.offset_m));
    distance.plane_rad = std::max(distance.plane_rad, here.normal.cross(optimum.normal).norm());
  }
  const double dof = summary.num_residuals_reduced - summary.num_effective_parameters_reduced;
  distance.chi2_per_dof = 2.0 * (summary.initial_cost - summary.final_cost) / dof;
  distance.batch_chi2_per_dof = 2.0 * summary.final_cost / dof;
  return distance;
}

}  // namespace sgraphs::testing_support
