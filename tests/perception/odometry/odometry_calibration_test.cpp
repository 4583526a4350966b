// Whether the covariances of the links between keyframes are their errors. SGRAPHS_CALIBRATION_SEEDS=n
// measures over n longer walks.
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cstdlib>
#include <map>
#include <string>

#include "perception/odometry/odometry.h"
#include "tests/perception/odometry/simulated_walk.h"

namespace sgraphs {
namespace {

using namespace testing_support;

constexpr double kChi2Of95Percent = 7.8147;  // three degrees of freedom

struct Calibration {
  int count = 0;
  double nees_m = 0, nees_rad = 0;          // sums over the links
  int inside_m = 0, inside_rad = 0;         // of the 95 % ellipsoids
  double squares_m2 = 0, squares_rad2 = 0;  // of the errors
};

double nees(const Eigen::Vector3d& error, const Eigen::Matrix3d& covariance) {
  return error.dot(covariance.ldlt().solve(error));
}

void addLinks(const OdometryRun& run, const simulate::Trajectory& truth,
              std::map<RelativePoseKind, Calibration>& sums) {
  for (const Keyframe& keyframe : run.keyframes) {
    for (const RelativePose& r : keyframe.relative_poses) {
      const Time from = run.keyframes[static_cast<size_t>(r.from.value)].time;
      const SE3 true_T_from_to = truth.poseAt(from).inverse() * truth.poseAt(keyframe.time);
      const Vector6d error = se3Log(r.T_from_to.inverse() * true_T_from_to);
      const double m = nees(error.head<3>(), r.covariance.topLeftCorner<3, 3>());
      const double rad = nees(error.tail<3>(), r.covariance.bottomRightCorner<3, 3>());
      Calibration& c = sums[r.kind];
      ++c.count;
      c.nees_m += m;
      c.nees_rad += rad;
      c.inside_m += m <= kChi2Of95Percent;
      c.inside_rad += rad <= kChi2Of95Percent;
      c.squares_m2 += error.head<3>().squaredNorm();
      c.squares_rad2 += error.tail<3>().squaredNorm();
    }
  }
}

TEST(OdometryCalibrationTest, CovariancesOfLinksAreTheirErrors) {
  const char* wanted = std::getenv("SGRAPHS_CALIBRATION_SEEDS");
  const uint64_t seeds = wanted ? std::strtoull(wanted, nullptr, 10) : 3;
  std::map<OdometryMode, std::map<RelativePoseKind, Calibration>> sums;
  for (uint64_t seed = 1; seed <= seeds; ++seed) {
    simulate::Scene scene = furnishedRoom();
    if (!wanted) scene.path.waypoints.resize(2);
    scene.path.start_heading_rad = 0.5 * static_cast<double>(seed);
    const SimulatedWalk walk = walkThrough(scene, 100 + seed);
    // As measured: where the odometry has used the same points already, the graph gets the neighbours'
    // covariances deflated, which is no statement about their errors.
    OdometryConfig config;
    config.covariance.neighbour_deflation = 1.0;
    for (const OdometryMode mode : {OdometryMode::kLidar, OdometryMode::kFused, OdometryMode::kEncoder})
      addLinks(runOdometry(walk, mode, config), walk.truth, sums[mode]);
  }
  std::printf("%-8s %-10s %5s | NEES m %6s rad | inside m %5s rad | rms mm %6s mrad\n", "mode", "kind",
              "links", "", "", "");
  for (const auto& [mode, kinds] : sums) {
    for (const auto& [kind, c] : kinds) {
      const std::string name = kind == RelativePoseKind::kOdometry ? "odometry" : "neighbour";
      const double n = c.count;
      std::printf("%-8s %-10s %5d | %6.2f %10.2f | %7.2f %10.2f | %6.2f %8.2f\n", toString(mode).c_str(),
                  name.c_str(), c.count, c.nees_m / n, c.nees_rad / n, c.inside_m / n, c.inside_rad / n,
                  1e3 * std::sqrt(c.squares_m2 / n), 1e3 * std::sqrt(c.squares_rad2 / n));
      EXPECT_GE(c.count, 12);
      for (const double value : {c.nees_m / n, c.nees_rad / n}) {
        EXPECT_GT(value, 0.2) << toString(mode) << " " << name;
        EXPECT_LT(value, 12.0) << toString(mode) << " " << name;
      }
    }
  }
}

}  // namespace
}  // namespace sgraphs
