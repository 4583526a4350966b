#include "perception/odometry/registration.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>

#include "tests/perception/odometry/simulated_walk.h"

namespace sgraphs {
namespace {

using namespace testing_support;

const Matrix6d kNoPrior = Matrix6d::Zero();
const Time kBegin{1'000'000}, kEnd{1'100'000};
// Large enough for the beams to meet the floor: in a room of 6 m by 5 m only its corners would hold the
// height.
const simulate::Scene kRoom = simulate::makeBoxRoom(10, 8, 2.8);
const SE3 kTarget = poseOf({4.5, 3.7, 0.9}, 0.5, 1.0, 10);

// A room that the patches of two scans describe; truth is exact, ranges are in steps of 2 mm.
struct Pair {
  std::vector<Surfel> target, source;
  SE3 T_target_source;
};

Pair makePair(const SE3& T_target_source,
              const simulate::SensorModel& model = simulate::SensorModel::noiseFree(), uint64_t seed = 1) {
  const simulate::SimulatedWorld world(kRoom);
  return {surfelsOf(simulateScan(world, kTarget, model, seed)),
          surfelsOf(simulateScan(world, kTarget * T_target_source, model, seed + 1000)), T_target_source};
}

MotionPrior freePrior() {
  MotionPrior prior;
  prior.begin_information = 1e-3 * Matrix6d::Identity();
  return prior;
}

TEST(RegistrationTest, FindsTheTruthFromFiveCentimetresAndThreeDegreesOff) {
  const Pair pair = makePair(poseOf({0.35, -0.2, 0.02}, 1, -1, 6));
  const SurfelMap map = mapOf(pair.target, SE3());
  const SE3 offsets[] = {poseOf({0.05, 0, 0}, 0, 0, 3), poseOf({-0.03, 0.04, 0}, 0, 0, -3),
                         poseOf({0, 0, 0.05}, 2, -2, 0), poseOf({0, -0.05, 0}, 0, 3, 0)};
  for (const SE3& offset : offsets) {
    SE3 T = pair.T_target_source * offset;
    const RegistrationResult result = registerRigid(pair.source, map, kNoPrior, RegistrationConfig(), 1, T);
    EXPECT_LT(distance(T, pair.T_target_source), 0.002);
    EXPECT_LT(angle(T, pair.T_target_source), 0.0007);
    EXPECT_TRUE(result.converged);
    EXPECT_GT(result.inlier_share, 0.9);
    EXPECT_LT(result.residual_rms_m, 0.004);
  }
}

TEST(RegistrationTest, EndsWhereTheNumericGradientOfTheCostVanishes) {
  const Pair pair = makePair(poseOf({0.3, 0.1, 0}, 0, 0, 5), simulate::SensorModel(), 2);
  const SurfelMap map = mapOf(pair.target, SE3());
  RegistrationConfig config;
  config.cell_sigma_m = 0;  // the factors of the votes are then 1
  SE3 T = pair.T_target_source;
  const RegistrationResult result = registerRigid(pair.source, map, kNoPrior, config, 1, T);
  ASSERT_TRUE(result.converged);
  // The robust cost of the matches at the result, their variances held.
  struct Match {
    const Surfel* surfel;
    const MapCell* cell;
    double variance;
  };
  std::vector<Match> matches;
  for (const Surfel& s : pair.source) {
    const Eigen::Vector3d p = T * s.mean;
    const MapCell* cell =
        map.match(p, T.rotation * s.normal, 0.5 * config.gate_m, std::cos(config.max_normal_angle_rad));
    if (!cell) continue;
    const Eigen::Vector3d offset = p - cell->mean;
    const double along2 = offset.squaredNorm() - std::pow(cell->normal.dot(offset), 2);
    matches.push_back({&s, cell,
                       s.variance_m2 + cell->variance_m2 + cell->tilt_variance * along2 +
                           config.sigma_floor_m * config.sigma_floor_m});
  }
  const auto cost = [&](const SE3& at) {
    double sum = 0;
    for (const Match& m : matches) {
      const double r = m.cell->normal.dot(at * m.surfel->mean - m.cell->mean);
      const bool level = std::abs(m.cell->normal.z()) > 0.7;
      const double width2 = std::pow(level ? config.robust_width : config.robust_width_upright, 2);
      sum += 0.5 * width2 * std::log1p(r * r / (width2 * m.variance));
    }
    return sum;
  };
  Vector6d gradient;
  for (int k = 0; k < 6; ++k) {
    const Vector6d h = 1e-5 * Vector6d::Unit(k);
    gradient[k] = (cost(T * se3Exp(h)) - cost(T * se3Exp(-h))) / 2e-5;
  }
  // The Newton step that is left, against the thresholds at which the iteration may stop.
  const Vector6d step = result.lidar_information.ldlt().solve(gradient);
  EXPECT_LT(step.head<3>().norm(), 1e-4);
  EXPECT_LT(step.tail<3>().norm(), 2e-5);
}

// A third of the upright patches has walked off by 6 cm, as people do: the wide kernel gives way to them, the
// one that narrows less so. Floors and ceilings do not walk.
TEST(RegistrationTest, ThoseWhoWalkOffTogetherAreLeftBehind) {
  const Pair pair = makePair(poseOf({0.1, 0.05, 0}, 0, 0, 2), simulate::SensorModel(), 4);
  const SurfelMap map = mapOf(pair.target, SE3());
  std::vector<Surfel> walkers = pair.source;
  const Eigen::Vector3d walked = pair.T_target_source.rotation.conjugate() * Eigen::Vector3d(0.06, 0, 0);
  size_t upright = 0;
  for (Surfel& s : walkers)
    if (std::abs(s.normal.z()) < 0.7 && ++upright % 3 == 0) s.mean += walked;
  // How far those who walked draw the pose from where the others alone put it.
  const auto drawnWith = [&](double width) {
    RegistrationConfig config;
    config.robust_width_upright = width;
    SE3 among_walkers = pair.T_target_source, alone = pair.T_target_source;
    registerRigid(walkers, map, kNoPrior, config, 1, among_walkers);
    registerRigid(pair.source, map, kNoPrior, config, 1, alone);
    return distance(among_walkers, alone);
  };
  const double wide = drawnWith(RegistrationConfig().robust_width);
  const double narrow = drawnWith(RegistrationConfig().robust_width_upright);
  EXPECT_LT(narrow, 0.7 * wide);
}

TEST(RegistrationTest, CovarianceIsSmallWhereARoomIsSeenFromAllSides) {
  const Pair pair = makePair(poseOf({0.2, 0.1, 0}, 0, 0, 5), simulate::SensorModel(), 3);
  SE3 T = pair.T_target_source;
  const RegistrationResult result =
      registerRigid(pair.source, mapOf(pair.target, SE3()), kNoPrior, RegistrationConfig(), 1, T);
  const Vector6d sigma = result.covariance.diagonal().cwiseSqrt();
  EXPECT_GT(sigma.minCoeff(), 1e-5);
  EXPECT_LT(sigma.head<3>().maxCoeff(), 0.003);
  EXPECT_LT(sigma.tail<3>().maxCoeff(), 0.002);
  EXPECT_LT((result.covariance * result.lidar_information - Matrix6d::Identity()).norm(), 1e-6);
}

TEST(RegistrationTest, CorridorWithoutEndsLeavesOneDirectionToThePrior) {
  const simulate::SimulatedWorld world(simulate::makeCorridor(400, 2.0, 2.5));
  const SE3 T_begin = poseOf({200, 0.9, 1.0}, 0, 0, 0);
  const std::vector<Surfel> target = surfelsOf(simulateScan(world, T_begin));
  const std::vector<Surfel> source =
      surfelsOf(simulateScan(world, T_begin * poseOf({0.3, 0.05, 0}, 0, 0, 2)));
  Matrix6d prior = Matrix6d::Identity();
  prior.diagonal() << 100, 100, 100, 100, 100, 100;  // 10 cm, 0.1 rad
  SE3 T = poseOf({0.25, 0.0, 0.02}, 0, 0, 0);        // what the prior holds
  const RegistrationResult result =
      registerRigid(source, mapOf(target, SE3()), prior, RegistrationConfig(), 1, T);
  EXPECT_NEAR(T.translation.x(), 0.25, 0.03) << "along the corridor the prior stays";
  EXPECT_NEAR(T.translation.y(), 0.05, 0.004);
  EXPECT_NEAR(T.translation.z(), 0.0, 0.004);
  EXPECT_LT(so3Log(T.rotation.conjugate() * so3Exp({0, 0, 2 * M_PI / 180})).norm(), 0.002);
  const Eigen::Vector3d variances =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(result.covariance.topLeftCorner<3, 3>()).eigenvalues();
  EXPECT_GT(std::sqrt(variances[2]), 0.02) << "and its uncertainty is the prior's, not the LiDAR's";
  EXPECT_LT(std::sqrt(variances[1]), 0.002);
}

TEST(RegistrationTest, RecoversTheMotionDuringAScan) {
  const simulate::SimulatedWorld world(kRoom);
  const SurfelMap map = mapOf(surfelsOf(simulateScan(world, kTarget)), SE3());
  Vector6d twist;
  twist << 1.0, 0.2, -0.1, 0.1, -0.15, 0.9;
  const SE3 T_target_begin = poseOf({0.2, 0.1, 0}, 0, 0, 4);
  const LidarScan scan = simulateMovingScan(world, kTarget * T_target_begin, twist);
  const SE3 T_target_end = T_target_begin * se3Exp((scan.end - scan.begin).seconds() * twist);
  for (const size_t segments : {1u, 2u}) {
    // The guess: standing still, somewhat off.
    ScanMotion motion{scan.begin, scan.end,
                      std::vector<SE3>(segments + 1, T_target_begin * poseOf({0.02, -0.02, 0}, 0, 0, 1))};
    registerScan(surfelsOf(scan), map, freePrior(), RegistrationConfig(), 1, motion);
    EXPECT_LT(distance(motion.T_odom_body.front(), T_target_begin), 0.005);
    EXPECT_LT(angle(motion.T_odom_body.front(), T_target_begin), 0.0025);
    EXPECT_LT(distance(motion.T_odom_body.back(), T_target_end), 0.005);
    EXPECT_LT(angle(motion.T_odom_body.back(), T_target_end), 0.0025);
    const SE3 half = T_target_begin * se3Exp(0.5 * (scan.end - scan.begin).seconds() * twist);
    EXPECT_LT(distance(motion.at(static_cast<int32_t>((scan.begin - scan.end).us / 2)), half), 0.002);
  }
}

TEST(RegistrationTest, GivesTheSameBitsAtAnyNumberOfThreads) {
  const Pair pair = makePair(poseOf({0.3, 0.1, 0}, 0, 0, 5), simulate::SensorModel(), 4);
  const SurfelMap map = mapOf(pair.target, SE3());
  const auto run = [&](int threads) {
    ScanMotion motion{
        kBegin, kEnd, {pair.T_target_source, pair.T_target_source * poseOf({0.03, 0, 0}, 0, 0, 1)}};
    const RegistrationResult result =
        registerScan(pair.source, map, freePrior(), RegistrationConfig(), threads, motion);
    return std::pair(motion, result);
  };
  const auto [motion, result] = run(1);
  for (const int threads : {2, 4}) {
    const auto [other_motion, other] = run(threads);
    for (size_t j = 0; j < 2; ++j) {
      EXPECT_EQ(motion.T_odom_body[j].translation, other_motion.T_odom_body[j].translation);
      EXPECT_EQ(motion.T_odom_body[j].rotation.coeffs(), other_motion.T_odom_body[j].rotation.coeffs());
    }
    EXPECT_EQ(result.covariance, other.covariance);
    EXPECT_EQ(result.lidar_information, other.lidar_information);
    EXPECT_EQ(result.residual_rms_m, other.residual_rms_m);
  }
}

TEST(RegistrationTest, ThereAndBackIsTheIdentity) {
  const Pair pair = makePair(poseOf({0.4, -0.2, 0.03}, 1, 1, 8), simulate::SensorModel(), 5);
  SE3 there = pair.T_target_source * poseOf({0.03, 0.02, 0}, 0, 0, 1);
  SE3 back = pair.T_target_source.inverse();
  registerRigid(pair.source, mapOf(pair.target, SE3()), kNoPrior, RegistrationConfig(), 1, there);
  registerRigid(pair.target, mapOf(pair.source, SE3()), kNoPrior, RegistrationConfig(), 1, back);
  EXPECT_LT(distance(there * back, SE3()), 0.004);
  EXPECT_LT(angle(there * back, SE3()), 0.001);
}

TEST(RegistrationTest, DoesNotDependOnTheFrames) {
  const Pair pair = makePair(poseOf({0.4, -0.2, 0.03}, 1, 1, 8), simulate::SensorModel(), 6);
  SE3 T = pair.T_target_source * poseOf({0.03, 0.02, 0}, 0, 0, 1);
  const SE3 guess = T;
  registerRigid(pair.source, mapOf(pair.target, SE3()), kNoPrior, RegistrationConfig(), 1, T);
  // The source's frame moves: the same answer, but for rounding.
  const SE3 S = poseOf({30, -20, 5}, 20, -35, 130);
  std::vector<Surfel> moved;
  for (Surfel s : pair.source) {
    s.mean = S * s.mean;
    s.normal = S.rotation * s.normal;
    moved.push_back(s);
  }
  SE3 T_target_moved = guess * S.inverse();
  registerRigid(moved, mapOf(pair.target, SE3()), kNoPrior, RegistrationConfig(), 1, T_target_moved);
  EXPECT_LT(distance(T_target_moved * S, T), 1e-3);
  EXPECT_LT(angle(T_target_moved * S, T), 1e-4);
  // The target's frame moves: other cubes cut the walls, the same answer within the noise.
  const SE3 Q = poseOf({-7, 3, 1}, 0, 0, 40);
  SE3 T_moved_source = Q * guess;
  registerRigid(pair.source, mapOf(pair.target, Q), kNoPrior, RegistrationConfig(), 1, T_moved_source);
  EXPECT_LT(distance(Q.inverse() * T_moved_source, T), 0.004);
  EXPECT_LT(angle(Q.inverse() * T_moved_source, T), 0.001);
}

TEST(RegistrationTest, WithoutMatchesThePriorStaysAndSaysSo) {
  MotionPrior prior = freePrior();
  prior.relative = {poseOf({0.1, 0, 0}, 0, 0, 1)};
  prior.relative_information = {1e4 * Matrix6d::Identity()};
  ScanMotion motion{kBegin, kEnd, {SE3(), prior.relative[0]}};
  const RegistrationResult result = registerScan({}, SurfelMap(0.5), prior, RegistrationConfig(), 1, motion);
  EXPECT_EQ(result.matches, 0);
  EXPECT_EQ(result.inlier_share, 0);
  EXPECT_LT(distance(motion.T_odom_body.back(), prior.relative[0]), 1e-6);
  // Nothing is claimed to be known worse than one metre or radian.
  EXPECT_GT(result.covariance.diagonal().minCoeff(), 0.4);
}

TEST(ScanMotionTest, PlacesInstantsBetweenItsKnots) {
  ScanMotion motion{
      kBegin, kEnd, {SE3(), SE3(so3Exp({0, 0, 0.2}), {1, 0, 0}), SE3(so3Exp({0, 0, 0.4}), {3, 0, 0})}};
  EXPECT_EQ(motion.placeOf(-100000).knot, 0u);
  EXPECT_DOUBLE_EQ(motion.placeOf(-100000).share, 0.0);
  EXPECT_EQ(motion.placeOf(-75000).knot, 0u);
  EXPECT_NEAR(motion.placeOf(-75000).share, 0.5, 1e-12);
  EXPECT_EQ(motion.placeOf(0).knot, 1u);
  EXPECT_DOUBLE_EQ(motion.placeOf(0).share, 1.0);
  EXPECT_DOUBLE_EQ(motion.placeOf(99999).share, 1.0) << "clamped";
  EXPECT_DOUBLE_EQ(motion.placeOf(-999999).share, 0.0) << "clamped";
  EXPECT_LT(distance(motion.at(-50000), motion.T_odom_body[1]), 1e-12);
  EXPECT_EQ(motion.step().us, 50000);
}

}  // namespace
}  // namespace sgraphs
